#pragma once

#include <cstddef>
#include <type_traits>

#include "fpbm/core/detail/lane_access.hpp"
#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/detail/parts.hpp"
#include "fpbm/inverse/detail/attempts.hpp"
#include "fpbm/inverse/detail/joint_ranges.hpp"
#include "fpbm/inverse/detail/stack_search.hpp"
#include "fpbm/inverse/detail/tip_search.hpp"
#include "fpbm/model/manipulability.hpp"
#include "fpbm/task/detail/stack_kinematics.hpp"

namespace fpbm {

/// The arm with another Scalar, or the arm itself for an equal Scalar.
template <typename Other, typename Arm>
[[nodiscard]] auto arm_in(const Arm& arm) {
  if constexpr (std::is_same_v<Other, typename Arm::Scalar>) {
    return arm;
  } else {
    return arm.template cast<Other>();
  }
}

/// StackSearch for a stack of tasks, or TipSearch for the tip of an arm.
template <typename Arm, typename Space, typename Bounds_>
using SearchOf = std::conditional_t<kIsProduct<Space>, StackSearch<Arm, Bounds_>, TipSearch<Arm, Space>>;

/// Manipulability of the first level, in the units of the tasks: the lengths of the selections are divided out.
template <typename... Levels, int N, typename Scalar>
[[nodiscard]] Scalar manipulability(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics) noexcept {
  Scalar value = manipulability(first_rows(kinematics));
  kinematics.each_task([&](auto level, const auto& task, int) noexcept {
    for (Eigen::Index i = 0; level == 0 && i < task.S.rows(); ++i) value /= task.S.row(i).norm();
  });
  return value;
}

/// Sets `best` to an attempt of Many, in a lane, that gave up nearer to the target. one: search of single postures.
template <typename Many, typename One>
void keep_better(const One& one, const typename Many::Trial& now, [[maybe_unused]] std::size_t lane,
                 typename One::Trial& best) noexcept {
  if constexpr (kInLanes<typename Many::Scalar>) {
    if (!(now.cost[lane] < best.cost)) return;
    best.cost = now.cost[lane];
    best.q = lane_of(now.q, lane);
  } else {
    one.take(one.better(now, best), now, best);
  }
}

/// Attempts from start postures that fill the ranges, one for each lane of the Scalar. When an attempt ends, the next
/// attempt starts in its lane. Search: TipSearch or StackSearch.
template <typename Search>
class StartSearch {
 public:
  using Scalar = typename Search::Scalar;
  using Trial = typename Search::Trial;

  /// most: largest number of starts, including the starts already used.
  template <typename Ranges, typename Start>
  StartSearch(const Search& search, const Ranges& ranges, const Start& start, Number<Scalar> seed, int used,
              int most) noexcept
      : search_(search), attempts_(search), spread_(ranges, start, seed), used_(used), most_(most) {}

  /// Number of starts used.
  [[nodiscard]] int used() const noexcept { return used_; }

  /// Makes steps until found(posture) returns true, or all starts are used. Calls found() for each posture that reaches
  /// the target, and gives_up(trial, lane) for each attempt that gives up.
  template <typename Found, typename GivesUp>
  void run(const Found& found, const GivesUp& gives_up) noexcept {
    for (bool is_done = false; !is_done && start_attempts();) {
      const Mask<Scalar> ends = active_ && attempts_.step();
      const Mask<Scalar> reached = active_ && search_.reached(attempts_.now());
      active_ = active_ && !(ends || reached);
      each_lane<Scalar>(reached, [&](std::size_t lane) noexcept {
        if (is_done) return;
        attempts_.settle();
        is_done = found(lane_of(attempts_.now().q, lane));
      });
      each_lane<Scalar>(ends && !reached, [&](std::size_t lane) noexcept { gives_up(attempts_.now(), lane); });
    }
  }

 private:
  /// Starts attempts in the free lanes. Returns false if no attempt is active.
  [[nodiscard]] bool start_attempts() noexcept {
    Mask<Scalar> starting(false);
    each_lane<Scalar>(!active_, [&](std::size_t lane) noexcept {
      if (used_ == most_) return;
      ++used_;
      set_true<Scalar>(starting, lane);
      set_true<Scalar>(active_, lane);
    });
    if (!none_of(starting)) {
      const int patience = kPatience + used_ / kStartsPerPatience;
      attempts_.start(starting, spread_.nearest(search_, number_), Scalar(Number<Scalar>(patience)));
      number_ += Scalar(Number<Scalar>(kLanesOf<Scalar>));
    }
    return !none_of(active_);
  }

  /// Later attempts are more patient, for targets near singular postures. The value is a choice: the patience doubles
  /// in 64 starts.
  static constexpr int kStartsPerPatience = 16;

  const Search& search_;
  Attempts<Search> attempts_;
  SpreadPostures<Search::N, Scalar> spread_;
  Mask<Scalar> active_{false};
  Scalar number_ = lane_numbers<Scalar>();
  int used_;
  int most_;
};

}  // namespace fpbm
