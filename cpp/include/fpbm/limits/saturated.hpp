#pragma once

#include <cstdint>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// A joint motion within a box.
template <int N, typename Scalar = double>
struct Saturated {
  Vector<N, Scalar> u;
  Scalar scale;            ///< Task scale s in [0, 1].
  JointBits joints;        ///< Bit i is set where joint i is on its bound.
  int passes;              ///< Number of passes; 0 if the desired motion is in the box.
  std::uint32_t rows = 0;  ///< Bit k is set where row k is on its bound.
};

}  // namespace fpbm
