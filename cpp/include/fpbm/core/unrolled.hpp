#pragma once

#include <Eigen/Core>
#include <utility>

namespace fpbm {

/// An index known at compile time.
template <Eigen::Index I>
struct Constant {
  static constexpr Eigen::Index kIndex = I;
  constexpr operator Eigen::Index() const noexcept { return I; }
};

template <Eigen::Index I>
[[nodiscard]] constexpr Constant<I + 1> next(Constant<I>) noexcept {
  return {};
}
[[nodiscard]] constexpr Eigen::Index next(Eigen::Index i) noexcept {
  return i + 1;
}

/// Largest size whose loops are written out.
inline constexpr int kUnrolled = 8;

/// Size known at compile time if N is small, else at run time.
template <int N>
[[nodiscard]] constexpr auto extent([[maybe_unused]] Eigen::Index size) noexcept {
  if constexpr (N != Eigen::Dynamic && N <= kUnrolled) {
    return Constant<N>{};
  } else {
    return N == Eigen::Dynamic ? size : Eigen::Index(N);
  }
}

/// Number of pairs that hold a number of things, the last one perhaps half.
template <Eigen::Index I>
[[nodiscard]] constexpr Constant<(I + 1) / 2> pairs_of(Constant<I>) noexcept {
  return {};
}
[[nodiscard]] constexpr Eigen::Index pairs_of(Eigen::Index i) noexcept {
  return (i + 1) / 2;
}

/// f(i) for i from first up to, but not including, last.
template <typename F>
void each(Eigen::Index first, Eigen::Index last, const F& f) noexcept {
  for (Eigen::Index i = first; i < last; ++i) f(i);
}

template <Eigen::Index First, typename F, Eigen::Index... I>
[[gnu::always_inline]] inline void each_of(std::integer_sequence<Eigen::Index, I...>,
                                           [[maybe_unused]] const F& f) noexcept {
  (f(Constant<First + I>{}), ...);
}

/// The same with each call written out and i a Constant: nothing is left of the loop.
template <Eigen::Index First, Eigen::Index Last, typename F>
[[gnu::always_inline]] inline void each(Constant<First>, Constant<Last>, const F& f) noexcept {
  each_of<First>(std::make_integer_sequence<Eigen::Index, (First < Last ? Last - First : 0)>{}, f);
}

}  // namespace fpbm
