#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "fpbm/bound/task_bounds.hpp"

namespace fpbm {

/// Bounds on the position p of the origin of a frame in the base frame, for each coordinate:
///
///   lowerᵢ ≤ pᵢ ≤ upperᵢ
template <typename Scalar = double>
struct PositionBounds {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();

  LinkFrame<Scalar> frame;
  Vector<3, Scalar> lower = Vector<3, Scalar>::Constant(-kNone);  ///< [m]
  Vector<3, Scalar> upper = Vector<3, Scalar>::Constant(kNone);   ///< [m]
  Scalar deceleration = kNone;                                    ///< Largest deceleration toward the bounds [m/s²].
  std::string name = "tip";

  /// Throws std::invalid_argument if a bound is out of range, or the link does not exist.
  template <int N, int Joints>
  void add_to(TaskBounds<N, Scalar, Joints>& bounds) const {
    const auto point = bounds.point(frame);
    for (int i = 0; i < 3; ++i) {
      if (!(lower(i) < upper(i))) validation::fail(validation::element("lower", i), lower(i), "below upper");
      const std::string axis(1, "xyz"[i]);
      const Vector<3, Scalar> n = Vector<3, Scalar>::Unit(i);
      if (std::isfinite(lower(i))) bounds.add({point, n, lower(i), deceleration, "lower " + axis + " of " + name});
      if (std::isfinite(upper(i))) bounds.add({point, -n, -upper(i), deceleration, "upper " + axis + " of " + name});
    }
  }
};

}  // namespace fpbm
