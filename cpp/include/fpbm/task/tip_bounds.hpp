#pragma once

#include <limits>

namespace fpbm {

/// How fast a tip may go; infinite where there is no bound.
template <typename Scalar = double>
struct TipBounds {
  Scalar speed = std::numeric_limits<Scalar>::infinity();              ///< [m/s]
  Scalar acceleration = std::numeric_limits<Scalar>::infinity();       ///< [m/s²]
  Scalar turn_rate = std::numeric_limits<Scalar>::infinity();          ///< [rad/s]
  Scalar turn_acceleration = std::numeric_limits<Scalar>::infinity();  ///< [rad/s²]
};

}  // namespace fpbm
