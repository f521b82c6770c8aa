#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "fpbm/bound/task_bounds.hpp"

namespace fpbm {

/// Bounds on the angle θ between an axis a of a frame and a direction d (a cone about d):
///
///   lower ≤ θ ≤ upper
///
/// cos θ = d·a is the coordinate along d of the unit vector a.
template <typename Scalar = double>
struct AxisBounds {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();

  LinkFrame<Scalar> frame;
  Vector<3, Scalar> axis = Vector<3, Scalar>::UnitZ();  ///< In the frame. Any positive length.
  Vector<3, Scalar> direction;                          ///< In the base frame. Any positive length.
  Scalar lower = Scalar(0);                             ///< [rad]
  Scalar upper = kNone;                                 ///< [rad]; no bound if π or more.
  Scalar deceleration = kNone;                          ///< Largest deceleration of cos θ toward the bounds [1/s²].
  std::string name = "axis";

  /// Throws std::invalid_argument if a bound is out of range, or the link does not exist.
  template <int N, int Joints>
  void add_to(TaskBounds<N, Scalar, Joints>& bounds) const {
    const auto a = bounds.direction(frame, unit_vector("axis", axis));
    const Vector<3, Scalar> d = unit_vector("direction", direction);
    validation::require_non_negative("lower", lower);
    if (!(lower < upper)) validation::fail("lower", lower, "below upper");
    constexpr Scalar kHalfTurn = Scalar(3.14159265358979323846);
    if (upper < kHalfTurn) bounds.add({a, d, std::cos(upper), deceleration, "largest angle of " + name});
    if (lower > Scalar(0)) bounds.add({a, -d, -std::cos(lower), deceleration, "least angle of " + name});
  }
};

}  // namespace fpbm
