#pragma once

#include <cstdint>

#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// A guard without pairs.
struct Unguarded {
  [[nodiscard]] static constexpr bool empty() noexcept { return true; }
  [[nodiscard]] static constexpr bool is_near(std::uint32_t) noexcept { return false; }
  [[nodiscard]] static constexpr double near_distance_sum() noexcept { return 0.0; }
  template <Level kLevel, int N, typename Scalar>
  [[nodiscard]] static Rows<N, 0, Scalar> rows(const Limits<kLevel, N, Scalar>&, const State<N, Scalar>&) noexcept {
    return {};
  }
};

}  // namespace fpbm
