#pragma once

#include "fpbm/core/unrolled.hpp"

namespace fpbm {

template <Eigen::Index Count, typename Value>
[[nodiscard, gnu::always_inline]] inline Value sum_by_halves(const Value* terms) noexcept {
  if constexpr (Count == 1) {
    return terms[0];
  } else {
    return sum_by_halves<Count / 2>(terms) + sum_by_halves<Count - Count / 2>(terms + Count / 2);
  }
}

template <Eigen::Index First, typename F, Eigen::Index... I>
[[nodiscard, gnu::always_inline]] inline auto total_of(std::integer_sequence<Eigen::Index, I...>, const F& f) noexcept {
  const decltype(f(Constant<First>{})) terms[] = {f(Constant<First + I>{})...};
  return sum_by_halves<sizeof...(I)>(terms);
}

/// f(i) summed over Count indices from First on, halves apart: the additions wait for each other log₂ Count times, and
/// not Count times.
template <Eigen::Index First, Eigen::Index Count, typename F>
[[nodiscard, gnu::always_inline]] inline auto total(const F& f) noexcept {
  return total_of<First>(std::make_integer_sequence<Eigen::Index, Count>{}, f);
}

}  // namespace fpbm
