#pragma once

#include <limits>

namespace fpbm {

/// Bounds on the motion of the tip, infinite if there is no bound.
template <typename Scalar = double>
struct TipBounds {
  Scalar velocity = std::numeric_limits<Scalar>::infinity();              ///< [m/s]
  Scalar acceleration = std::numeric_limits<Scalar>::infinity();          ///< [m/s²]
  Scalar angular_velocity = std::numeric_limits<Scalar>::infinity();      ///< [rad/s]
  Scalar angular_acceleration = std::numeric_limits<Scalar>::infinity();  ///< [rad/s²]
  Scalar jerk = std::numeric_limits<Scalar>::infinity();                  ///< [m/s³]
  Scalar angular_jerk = std::numeric_limits<Scalar>::infinity();          ///< [rad/s³]
};

}  // namespace fpbm
