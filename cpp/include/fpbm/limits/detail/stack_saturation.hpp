#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "fpbm/limits/detail/saturation.hpp"
#include "fpbm/limits/detail/task_levels.hpp"
#include "fpbm/linalg/detail/level_space.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/singular/detail/damped_level.hpp"
#include "fpbm/singular/detail/scaled_level.hpp"

namespace fpbm {

/// Saturates a desired motion u* level by level, each level in the null space of the higher levels (docs/priority.md,
/// Levels within limits):
///
///   v = u* − u_{k−1},   p = Z Zᵀ v,   d = u_{k−1} + p + Z (J_k Z)⁺ J_k (v − p),   Z = Z_{k−1}
///   u_k = u_{k−1} + s_k (d − u_{k−1}) + Z_k γ  within the bounds,   s_k ∈ [0, 1] as large as possible.
///
/// u* determines the commands b_k = J_k u* and the preferred null-space motion. J_k d = J_k u*. If the scale of every
/// higher level is 1, d = u*. In lost directions, the pseudoinverse is damped (ScaledLevel, DampedLevel, kLevelRadius).
/// NullSpaceSaturation resolves the first level, with the task J₁ u* and the null-space motion of u*.
template <int N, typename Scalar, int P, typename... Matrices>
class StackSaturation {
 public:
  using JointVector = Vector<N, Scalar>;
  static constexpr int kLevels = static_cast<int>(sizeof...(Matrices));
  using Result = SaturatedLevels<N, Scalar, kLevels>;

  /// unit: unit of each joint's motion, for example its bound on acceleration.
  StackSaturation(const TaskLevels<N, Scalar, Matrices...>& levels, const JointVector& unit,
                  const Rows<N, P, Scalar>& rows = {}) noexcept
      : levels_(levels),
        unit_(unit),
        rows_(rows),
        above_(space_of(levels.first(), unit)),
        first_(first_saturation(levels.first(), above_, unit, rows)) {
    first_.limit_compensation();
  }

  /// Resolves the first level. rest: motion within the bounds from which the level starts.
  [[nodiscard]] Result operator()(const Box<N, Scalar>& box, const JointVector& rest,
                                  const JointVector& desired) noexcept {
    Result result{first_(box, rest, desired), {}};
    // Scale of a level that is left out, or that the higher levels determine.
    result.scales.fill(Scalar(1));
    result.scales[0] = result.scale;
    return result;
  }

  /// Resolves the lower levels, starting from the motion of the first level. J_k u of a higher level does not change.
  void resolve_lower(const Box<N, Scalar>& box, const JointVector& desired, Result& result) const noexcept {
    bool whole = result.scale == Scalar(1);
    if (whole && box.contains(desired) && rows_.admit(desired)) {
      result.u = desired;
      return;
    }
    LevelSpace<N, Scalar> space = above_;
    levels_.each_lower([&](std::size_t k, const auto& rows) noexcept {
      if (space.rank() == space.size()) return;  // The higher levels determine the motion.
      const JointVector goal =
          whole ? desired : result.u + unit_.cwiseProduct(correction(space, rows, JointVector(desired - result.u)));
      if (whole) space.add(in_units(rows, unit_));
      if (!goal.allFinite()) {
        result.scales[k] = Scalar(0);
      } else if (box.contains(goal) && rows_.admit(goal)) {
        result.u = goal;
      } else {
        NullSpaceSaturation<Eigen::Dynamic, N, Scalar, P> saturation(space, unit_, rows_);
        saturation.limit_compensation();
        const SaturatedMotion<N, Scalar> found = saturation(box, result.u, goal);
        result.scales[k] = found.u.allFinite() ? found.scale : Scalar(0);
        if (found.u.allFinite()) result.u = found.u;
        result.joints |= found.joints;
        result.rows |= found.rows;
        result.passes += found.passes;
      }
      whole = whole && result.scales[k] == Scalar(1);
    });
  }

 private:
  /// Type of the saturation of the first level. One level alone is saturated as a task without levels.
  using FirstRows = std::tuple_element_t<0, std::tuple<Matrices...>>;
  static constexpr int kFirst = kLevels == 1 ? FirstRows::RowsAtCompileTime : Eigen::Dynamic;
  using First = NullSpaceSaturation<kFirst, N, Scalar, P>;

  [[nodiscard]] static LevelSpace<N, Scalar> space_of(const FirstRows& first, const JointVector& unit) noexcept {
    LevelSpace<N, Scalar> space(unit.size());
    if constexpr (kLevels > 1) space.add(in_units(first, unit));
    return space;
  }
  [[nodiscard]] static First first_saturation(const FirstRows& first, LevelSpace<N, Scalar>& space,
                                              const JointVector& unit, const Rows<N, P, Scalar>& rows) noexcept {
    if constexpr (kLevels == 1) {
      return {first, unit, rows};
    } else {
      return {space, unit, rows};
    }
  }

  /// (d − u)/unit for v = u* − u. Adds the level to the space.
  template <typename LevelRows>
  [[nodiscard]] JointVector correction(LevelSpace<N, Scalar>& space, const LevelRows& rows,
                                       const JointVector& v) const noexcept {
    const LevelRows scaled = in_units(rows, unit_);
    const JointVector in_unit = v.cwiseQuotient(unit_);
    constexpr Scalar kRadius = kLevelRadius<Scalar>;
    if constexpr (std::is_same_v<LevelRows, DiagonalLevel<N, Scalar>>) {
      // A posture without lost directions determines the motion: p cancels.
      DampedLevel<N, Scalar> damped(kRadius * kRadius);
      const auto level = scaled_level(scaled, product(scaled, in_unit));
      if (!damped.loses(level.J.least())) return space.add(level.J, level.r, damped);
    }
    const JointVector projected = space.project(in_unit);
    const auto level = scaled_level(scaled, product(scaled, JointVector(in_unit - projected)));
    DampedLevel<decltype(level.r)::RowsAtCompileTime, Scalar> damped(kRadius * kRadius);
    return projected + space.add(level.J, level.r, damped);
  }

  const TaskLevels<N, Scalar, Matrices...>& levels_;
  JointVector unit_;
  Rows<N, P, Scalar> rows_;
  LevelSpace<N, Scalar> above_;  ///< Null space of the first level.
  First first_;
};

/// saturation_of() for several levels.
template <int N, typename Scalar, int P, typename... Matrices>
[[nodiscard]] StackSaturation<N, Scalar, P, Matrices...> saturation_of(const TaskLevels<N, Scalar, Matrices...>& levels,
                                                                       const Vector<N, Scalar>& unit,
                                                                       const Rows<N, P, Scalar>& rows) noexcept {
  return {levels, unit, rows};
}

template <int N, typename Scalar, int P, typename... Matrices>
void resolve_lower(const StackSaturation<N, Scalar, P, Matrices...>& saturation, const Box<N, Scalar>& box,
                   const Vector<N, Scalar>& desired, SaturatedLevels<N, Scalar, sizeof...(Matrices)>& found) noexcept {
  saturation.resolve_lower(box, desired, found);
}

/// Part of a motion in the null space of all levels.
template <int N, typename Scalar, typename... Matrices>
[[nodiscard]] Vector<N, Scalar> null_space_motion(const TaskLevels<N, Scalar, Matrices...>& levels,
                                                  const Vector<N, Scalar>& v) noexcept {
  LevelSpace<N, Scalar> space(v.size());
  space.add(levels.first());
  levels.each_lower([&](std::size_t, const auto& rows) noexcept { space.add(rows); });
  return space.project(v);
}

}  // namespace fpbm
