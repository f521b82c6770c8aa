#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "fpbm/bound/detail/coordinate_bounds.hpp"

namespace fpbm {

/// Bound of a Tracker: walls (PositionBounds) and cones (AxisBounds), which hold at every tick.
template <int N, typename Scalar = double, int Joints = N>
class TaskBounds : public CoordinateBounds<N, Scalar, Joints> {
 public:
  /// source: the Tree or the Chain of the robot.
  template <typename Source>
  explicit TaskBounds(const Source& source) : CoordinateBounds<N, Scalar, Joints>(source) {}

  /// Adds PositionBounds or AxisBounds. Throws std::invalid_argument if a bound is out of range, or the link does not
  /// exist.
  template <typename Given>
  void keep(const Given& bounds) {
    bounds.add_to(*this);
  }
};

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
  void add_to(CoordinateBounds<N, Scalar, Joints>& bounds) const {
    const auto point = bounds.placed().point(frame);
    for (int i = 0; i < 3; ++i) {
      if (!(lower(i) < upper(i))) validation::fail(validation::element("lower", i), lower(i), "below upper");
      const std::string axis(1, "xyz"[i]);
      const Vector<3, Scalar> n = Vector<3, Scalar>::Unit(i);
      if (std::isfinite(lower(i))) bounds.add({point, n, lower(i), deceleration, "lower " + axis + " of " + name});
      if (std::isfinite(upper(i))) bounds.add({point, -n, -upper(i), deceleration, "upper " + axis + " of " + name});
    }
  }
};

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
  void add_to(CoordinateBounds<N, Scalar, Joints>& bounds) const {
    const auto a = bounds.placed().direction(frame, unit_vector("axis", axis));
    const Vector<3, Scalar> d = unit_vector("direction", direction);
    validation::require_non_negative("lower", lower);
    if (!(lower < upper)) validation::fail("lower", lower, "below upper");
    constexpr Scalar kHalfTurn = Scalar(3.14159265358979323846);
    if (upper < kHalfTurn) bounds.add({a, d, std::cos(upper), deceleration, "largest angle of " + name});
    if (lower > Scalar(0)) bounds.add({a, -d, -std::cos(lower), deceleration, "least angle of " + name});
  }
};

}  // namespace fpbm
