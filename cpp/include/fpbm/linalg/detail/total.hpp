#pragma once

#include "fpbm/core/detail/unrolled.hpp"

namespace fpbm {

/// Σ f(i) over Count indices from First on, by pairwise summation: the longest chain of dependent additions has length
/// log₂ Count instead of Count. Sums of two to four terms are written out, which saves a compiler most of the calls.
template <Eigen::Index First, Eigen::Index Count, typename F>
[[nodiscard, gnu::always_inline]] inline auto total(const F& f) noexcept {
  const Constant<First> i{};
  if constexpr (Count == 1) {
    return f(i);
  } else if constexpr (Count == 2) {
    return f(i) + f(next(i));
  } else if constexpr (Count == 3) {
    return f(i) + (f(next(i)) + f(next(next(i))));
  } else if constexpr (Count == 4) {
    return (f(i) + f(next(i))) + (f(next(next(i))) + f(next(next(next(i)))));
  } else {
    return total<First, Count / 2>(f) + total<First + Count / 2, Count - Count / 2>(f);
  }
}

}  // namespace fpbm
