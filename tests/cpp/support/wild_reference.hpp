#pragma once

#include <cmath>

#include "fpbm/path/reference.hpp"
#include "support/random.hpp"

namespace fpbm::test {

/// A reference that no joint can follow: it jumps, and its velocities and accelerations are too large.
template <typename Space>
[[nodiscard]] Reference<Space> wild_reference(Random& random, const typename Space::template Point<double>& tip) {
  constexpr int M = Space::kRows;
  const double size = std::pow(10.0, random.uniform(-2.0, 1.5));
  const Vector<M> displacement = random.uniform(M, -size, size);
  return {Space::template displace<double>(tip, displacement), random.uniform(M, -size, size),
          random.uniform(M, -size, size)};
}

}  // namespace fpbm::test
