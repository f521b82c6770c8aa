#pragma once

#include <cstdint>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Joint motion within a box, the result of a saturation.
template <int N, typename Scalar = double>
struct SaturatedMotion {
  Vector<N, Scalar> u;
  Scalar scale;            ///< Task scale s in [0, 1].
  JointBits joints;        ///< Bit i is set if joint i is on its bound.
  int passes;              ///< Number of passes; 0 if the desired motion is in the box.
  std::uint64_t rows = 0;  ///< Bit k is set if row k is on its bound.
};

}  // namespace fpbm
