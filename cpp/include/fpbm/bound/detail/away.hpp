#pragma once

namespace fpbm {

/// Null-space motion away from shapes: motion_away(). Disabled if the gain is 0. The default range is not
/// tuned: ten times the default margin in Python.
template <typename Scalar = double>
struct Away {
  Scalar gain = Scalar(0);     ///< [rad/(m s²)], or [rad/(m s)] at velocity level. Prismatic joints: [1/s²] or [1/s].
  Scalar range = Scalar(0.1);  ///< Distance beyond the margin at which the motion starts [m].
};

}  // namespace fpbm
