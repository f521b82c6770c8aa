#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Displacement d from the start of a shape, and its first two derivatives with respect to the fraction s of the shape.
template <typename Space, typename Scalar>
struct Curve {
  typename Space::template Point<Scalar> d;
  Vector<Space::kRows, Scalar> d1;
  Vector<Space::kRows, Scalar> d2;
};

}  // namespace fpbm
