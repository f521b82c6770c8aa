#pragma once

#include "fpbm/core/unrolled.hpp"

namespace fpbm {

/// f(i) summed over Count indices from First on, halves apart: the additions wait for each other log₂ Count times, and
/// not Count times.
template <Eigen::Index First, Eigen::Index Count, typename F>
[[nodiscard, gnu::always_inline]] inline auto total(const F& f) noexcept {
  if constexpr (Count == 1) {
    return f(Constant<First>{});
  } else {
    return total<First, Count / 2>(f) + total<First + Count / 2, Count - Count / 2>(f);
  }
}

}  // namespace fpbm
