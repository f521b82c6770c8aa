#pragma once

namespace fpbm {

/// Keeps an arm at a distance from shapes where its task leaves it free to: off where the gain is 0.
template <typename Scalar = double>
struct Away {
  Scalar gain = Scalar(0);  ///< [rad/(m s²)], or [rad/(m s)] at velocity level; a joint that slides: [1/s²], [1/s].
  Scalar range = Scalar(0.1);  ///< From the margin on [m].
};

}  // namespace fpbm
