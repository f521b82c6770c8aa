#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "fpbm/bound/detail/bound_body.hpp"
#include "fpbm/task/detail/link_frame.hpp"

namespace fpbm {

/// Bounds on the position p of the origin of a frame in the base frame, for each coordinate, and on the speed of the
/// origin:
///
///   lowerᵢ ≤ pᵢ ≤ upperᵢ        ‖(ṗᵢ)‖ ≤ velocity, over the coordinates of `rows`
///
/// The bounds on the position hold at every tick, as in a clearance: a tick is executed only if the robot can stop
/// within the bounds after the tick. The bound on the speed holds as far as the joint limits and the other rows admit.
template <typename Scalar = double>
struct PositionBounds {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();

  LinkFrame<Scalar> frame;
  Vector<3, Scalar> lower = Vector<3, Scalar>::Constant(-kNone);  ///< [m]
  Vector<3, Scalar> upper = Vector<3, Scalar>::Constant(kNone);   ///< [m]
  Scalar velocity = kNone;                                        ///< [m/s]
  Scalar deceleration = kNone;                                    ///< Largest deceleration toward the bounds [m/s²].
  std::array<bool, 3> rows = {true, true, true};                  ///< Coordinates that the speed includes.
  std::string name = "tip";

  /// Throws std::invalid_argument if a bound is out of range, or the link does not exist.
  template <int N, int Joints>
  void add_to(Clearance<N, Scalar, Joints>& clearance) const {
    const auto body = [&](const std::string& bound) { return bound_point(clearance, frame, bound + " of " + name); };
    for (int i = 0; i < 3; ++i) {
      if (!(lower(i) < upper(i))) validation::fail(validation::element("lower", i), lower(i), "below upper");
      const std::string axis(1, "xyz"[i]);
      const Vector<3, Scalar> n = Vector<3, Scalar>::Unit(i);
      if (std::isfinite(lower(i))) clearance.add_lower_bound(body("lower " + axis), n, lower(i), deceleration);
      if (std::isfinite(upper(i))) clearance.add_lower_bound(body("upper " + axis), -n, -upper(i), deceleration);
    }
    clearance.bound_speed({body("speed"), rows, velocity});
  }
};

/// Bounds on the angle θ between an axis a of a frame and a direction d (a cone about d), and on the speed of the axis:
///
///   lower ≤ θ ≤ upper        ‖ȧ‖ ≤ velocity
///
/// The bounds on the angle hold at every tick, like the bounds on the position in PositionBounds: cos θ = d·a is the
/// coordinate along d of the unit vector a, which is treated as a point that only revolute joints move.
template <typename Scalar = double>
struct AxisBounds {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();

  LinkFrame<Scalar> frame;
  Vector<3, Scalar> axis = Vector<3, Scalar>::UnitZ();  ///< In the frame. Any positive length.
  Vector<3, Scalar> direction;                          ///< In the base frame. Any positive length.
  Scalar lower = Scalar(0);                             ///< [rad]
  Scalar upper = kNone;                                 ///< [rad]; no bound if π or more.
  Scalar velocity = kNone;                              ///< [rad/s]
  Scalar deceleration = kNone;                          ///< Largest deceleration of cos θ toward the bounds [1/s²].
  std::string name = "axis";

  /// Throws std::invalid_argument if a bound is out of range, or the link does not exist.
  template <int N, int Joints>
  void add_to(Clearance<N, Scalar, Joints>& clearance) const {
    const Vector<3, Scalar> a = unit_vector("axis", axis);
    const Vector<3, Scalar> d = unit_vector("direction", direction);
    validation::require_non_negative("lower", lower);
    if (!(lower < upper)) validation::fail("lower", lower, "below upper");
    constexpr Scalar kHalfTurn = Scalar(3.14159265358979323846);
    const auto body = [&](const char* bound) { return bound_direction(clearance, frame, a, bound + (" of " + name)); };
    if (upper < kHalfTurn) clearance.add_lower_bound(body("largest angle"), d, std::cos(upper), deceleration);
    if (lower > Scalar(0)) clearance.add_lower_bound(body("least angle"), -d, -std::cos(lower), deceleration);
    clearance.bound_speed({body("speed"), {true, true, true}, velocity});
  }

 private:
  [[nodiscard]] static Vector<3, Scalar> unit_vector(const char* name, const Vector<3, Scalar>& vector) {
    validation::require_finite(name, vector);
    const Scalar length = vector.stableNorm();
    if (!(length > Scalar(0))) validation::fail(name, Scalar(0), "a nonzero vector");
    return vector / length;
  }
};

}  // namespace fpbm
