#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/bound/detail/bound_members.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// The bounds of Bounds, and calls for each bound.
template <typename... Each>
class BoundTuple {
 public:
  static_assert((kHas<Each, bound_member::RowCount> && ...), "a bound needs `static constexpr int kRows`");
  static_assert((kHas<Each, bound_member::StatusOfRows> && ...),
                "a bound needs `static constexpr fpbm::Status kStatus`");
  static_assert((kHas<Each, bound_member::Empty> && ...), "a bound needs `bool empty() const noexcept`");

  /// The bound of a type, for example the Clearance, whose obstacles can move.
  template <typename Bound>
  [[nodiscard]] Bound& get() noexcept {
    return std::get<Bound>(each_);
  }
  template <typename Bound>
  [[nodiscard]] const Bound& get() const noexcept {
    return std::get<Bound>(each_);
  }

  /// Whether a bound may accept a slower stop, or a tick that is nearer to the planned stop, after a refused tick.
  [[nodiscard]] bool bounds_torques() const noexcept {
    return ((kHas<Each, bound_member::SlowerStop, double> && !std::get<Each>(each_).empty()) || ...);
  }

  /// Calls f(ratio) for each torque in a motion: the torque divided by its bound, of bounds on torques.
  template <typename JointVector, typename F>
  void torque_ratios(const JointVector& q, const JointVector& qd, const JointVector& qdd, const F& f) const {
    each([&](const auto& bound) {
      if constexpr (kHas<std::decay_t<decltype(bound)>, bound_member::Models>) {
        if (bound.empty()) return;
        typename std::decay_t<decltype(bound.models()[0])>::State state;
        bound.models()[0].robot().update(q, qd, state);
        for (const auto& model : bound.models()) {
          const JointVector torques = model.inverse_dynamics(state, qdd);
          for (Eigen::Index i = 0; i < q.size(); ++i) f(torques(i) / bound.most()(i));
        }
      }
    });
  }

 protected:
  BoundTuple() = default;
  template <typename First, typename... More>
  explicit BoundTuple(First&& first, More&&... more) : each_(std::forward<First>(first), std::forward<More>(more)...) {}

  /// Calls f(bound) for each bound.
  template <typename F>
  void each(F&& f) noexcept {
    std::apply([&](auto&... bound) noexcept { (f(bound), ...); }, each_);
  }
  template <typename F>
  void each(F&& f) const noexcept {
    std::apply([&](const auto&... bound) noexcept { (f(bound), ...); }, each_);
  }

  /// f(bound) of a bound that knows shapes; `other` for any other bound.
  template <typename Bound, typename F, typename Other>
  [[nodiscard]] auto of_shapes([[maybe_unused]] const F& f, [[maybe_unused]] Other other) const noexcept {
    if constexpr (kHas<Bound, bound_member::MovesAway>) {
      return f(get<Bound>());
    } else {
      return other;
    }
  }

  std::tuple<Each...> each_;  // NOLINT(readability-identifier-naming): private for users, who see Bounds.
};

}  // namespace fpbm
