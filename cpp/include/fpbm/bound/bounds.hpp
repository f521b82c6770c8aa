#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/bound/detail/bound_members.hpp"
#include "fpbm/bound/detail/bound_tuple.hpp"
#include "fpbm/bound/detail/next_motion.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/limits/detail/rows.hpp"

namespace fpbm {

/// Everything that restricts the next motion of a Tracker beyond the joint limits: Bounds(a, b, …) joins bounds, for
/// example a Clearance, TaskBounds and SpeedBounds. Without arguments, nothing is restricted.
///
/// A tick is executed only if all bounds accept the stopping trajectory after the tick. Otherwise the arm continues the
/// stopping trajectory of the tick before: by induction, the bounds hold at every tick. The rows leave slack for
/// accepts(), so that the arm slides along a bound instead of stopping before the bound.
///
/// A bound of your own has these members (docs/architecture.md, "Add a bound"):
///
///   kRows                 largest number of rows
///   kStatus               status of a tick that the rows slow down: Status::kBlocked or Status::kSlowed
///   empty()               whether nothing is bounded
///   require(q)            throws std::invalid_argument if the posture q violates the bound
///   rows(next, rows)      adds g·u ≤ b for the next motion (NextMotion), at most kRows rows
///   accepts(limits, from, stop): whether the tick and the Stop after it keep the bound; true without a certificate
///   gaps(q, range, f)     for InverseKinematics and kept paths: calls f(gap, gradient) for each gap below range
///   speed_ratio(q, qd)    for fastest() only, of a bound on speeds: largest ratio of a speed to its bound
///   slower_stop(fraction), require_limits(limits), models(), most(): see TorqueBounds
///
/// rows() and accepts() are noexcept, and rows() is called before accepts(). A bound allocates at construction only.
template <typename... Each>
class Bounds : public BoundTuple<Each...> {
 public:
  static constexpr int kRows = (0 + ... + Each::kRows);
  static_assert(kRows <= 64, "at most 64 rows: the active rows are the bits of a std::uint64_t");

  Bounds() = default;
  using BoundTuple<Each...>::get;
  template <typename First, typename... More,
            typename = std::enable_if_t<
                sizeof...(More) + 1 == sizeof...(Each) &&
                std::is_same_v<std::tuple<std::decay_t<First>, std::decay_t<More>...>, std::tuple<Each...>>>>
  explicit Bounds(First&& first, More&&... more)
      : BoundTuple<Each...>(std::forward<First>(first), std::forward<More>(more)...) {}

  [[nodiscard]] bool empty() const noexcept {
    return std::apply([](const auto&... bound) { return (bound.empty() && ...); }, each_);
  }

  /// After a stop was refused: a smaller fraction of the bounds on deceleration with which a bound may accept a stop,
  /// or 0.
  template <typename Scalar>
  [[nodiscard]] Scalar slower_stop(Scalar fraction) const noexcept {
    Scalar slower(0);
    each([&](const auto& bound) noexcept {
      if constexpr (kHas<std::decay_t<decltype(bound)>, bound_member::SlowerStop, Scalar>) {
        if (!bound.empty()) slower = std::max(slower, bound.slower_stop(fraction));
      }
    });
    return slower;
  }

  template <typename JointVector>
  void require(const JointVector& q) {
    static_assert((kHas<Each, bound_member::Require, JointVector> && ...),
                  "a bound needs `void require(const JointVector& q)`");
    std::apply([&](auto&... bound) { (bound.require(q), ...); }, each_);
  }

  /// Throws std::invalid_argument if the bounds do not suit the level or the limits of a motion.
  template <Level kLevel, int N, typename Scalar>
  void require_limits(const Limits<kLevel, N, Scalar>& limits) const {
    const auto require = [&](const auto& bound) {
      if constexpr (kHas<std::decay_t<decltype(bound)>, bound_member::RequireLimits, Limits<kLevel, N, Scalar>>) {
        if (!bound.empty()) bound.require_limits(limits);
      }
    };
    std::apply([&](const auto&... bound) { (require(bound), ...); }, each_);
  }

  /// Rows on the next motion.
  template <Level kLevel, int N, typename Scalar>
  [[nodiscard]] Rows<N, kRows, Scalar> rows(const NextMotion<kLevel, N, Scalar>& next) noexcept {
    static_assert(
        (kHas<Each, bound_member::WriteRows, NextMotion<kLevel, N, Scalar>, Rows<N, kRows, Scalar>> && ...),
        "a bound needs `void rows(const NextMotion<kLevel, N, Scalar>& next, Rows<N, P, Scalar>& rows) noexcept`");
    Rows<N, kRows, Scalar> rows;
    if constexpr (kRows > 0) {
      rows.g.resize(next.state.q.size(), kRows);
      std::size_t i = 0;
      each([&](auto& bound) noexcept {
        if (!bound.empty()) bound.rows(next, rows);
        ends_[i++] = rows.count;
      });
    }
    return rows;
  }

  /// Status of a tick that rows slow down. active: bit k is set if row k acts.
  [[nodiscard]] Status status([[maybe_unused]] std::uint64_t active) const noexcept {
    Status status = Status::kSlowed;
    std::size_t i = 0;
    Eigen::Index k = 0;
    each([&]([[maybe_unused]] const auto& bound) noexcept {
      for (; k < ends_[i]; ++k) {
        if (((active >> k) & 1U) != 0) status = worse(status, std::decay_t<decltype(bound)>::kStatus);
      }
      ++i;
    });
    return status;
  }

  template <Level kLevel, int N, typename Scalar>
  [[nodiscard]] bool accepts(const Limits<kLevel, N, Scalar>& limits, const State<N, Scalar>& from,
                             const Stop<kLevel, N, Scalar>& stop) noexcept {
    static_assert(
        (kHas<Each, bound_member::Accepts, Limits<kLevel, N, Scalar>, State<N, Scalar>, Stop<kLevel, N, Scalar>> &&
         ...),
        "a bound needs `bool accepts(const Limits<kLevel, N, Scalar>& limits, const State<N, Scalar>& from, const "
        "Stop<kLevel, N, Scalar>& stop) noexcept`");
    return std::apply(
        [&](auto&... bound) noexcept { return ((bound.empty() || bound.accepts(limits, from, stop)) && ...); }, each_);
  }

  /// Calls f(gap, gradient) for each gap below the range in the posture q. The posture keeps all bounds if no gap is
  /// negative. gradient: of the gap with respect to the drives.
  template <typename JointVector, typename F>
  void gaps(const JointVector& q, typename JointVector::Scalar range, const F& f) noexcept {
    static_assert((kHas<Each, bound_member::Gaps, JointVector, F> && ...),
                  "a bound on the postures of InverseKinematics needs "
                  "`template <typename F> void gaps(const JointVector& q, Scalar range, const F& f) noexcept`");
    each([&](auto& bound) noexcept {
      if (!bound.empty()) bound.gaps(q, range, f);
    });
  }

  /// Sum of range − gap over the gaps below the range in the posture q, of bounds that have gaps.
  template <typename JointVector>
  [[nodiscard]] auto closeness(const JointVector& q, typename JointVector::Scalar range) noexcept {
    typename JointVector::Scalar sum(0);
    const auto add = [&](auto gap, const auto&) noexcept { sum += range - gap; };
    each([&](auto& bound) noexcept {
      if constexpr (kHas<std::decay_t<decltype(bound)>, bound_member::Gaps, JointVector, decltype(add)>) {
        if (!bound.empty()) bound.gaps(q, range, add);
      }
    });
    return sum;
  }

  /// Largest ratio of a speed to its bound at the joint velocities qd in the posture q, of bounds on speeds.
  template <typename JointVector>
  [[nodiscard]] auto speed_ratio(const JointVector& q, const JointVector& qd) noexcept {
    typename JointVector::Scalar largest(0);
    each([&](auto& bound) noexcept {
      if constexpr (kHas<std::decay_t<decltype(bound)>, bound_member::SpeedRatio, JointVector>) {
        largest = std::max(largest, bound.speed_ratio(q, qd));
      }
    });
    return largest;
  }

  /// Sum of the distances to near shapes [m]. While the arm is at rest, the sum changes only if obstacles move.
  [[nodiscard]] auto near_distance_sum() const noexcept {
    return (0.0 + ... +
            this->template of_shapes<Each>([](const auto& bound) { return bound.near_distance_sum(); }, 0.0));
  }
  [[nodiscard]] bool moves_away() const noexcept {
    return (this->template of_shapes<Each>([](const auto& bound) { return bound.moves_away(); }, false) || ...);
  }
  /// Null-space motion away from shapes in the posture q [rad/s², or rad/s at velocity level].
  template <typename JointVector>
  [[nodiscard]] JointVector away(const JointVector& q) noexcept {
    auto sum = filled<JointVector>(q.size());
    each([&](auto& bound) noexcept {
      if constexpr (kHas<std::decay_t<decltype(bound)>, bound_member::MovesAway>) {
        if (bound.moves_away()) sum += bound.away(q);
      }
    });
    return sum;
  }

 private:
  using BoundTuple<Each...>::each;
  using BoundTuple<Each...>::each_;

  std::array<Eigen::Index, sizeof...(Each)> ends_{};  ///< Number of rows after each bound.
};

template <typename... Each>
Bounds(Each...) -> Bounds<std::decay_t<Each>...>;

}  // namespace fpbm
