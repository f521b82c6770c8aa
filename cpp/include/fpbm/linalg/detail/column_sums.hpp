#pragma once

#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/product.hpp"

/// Loops over columns in pairs of entries. g++ does not vectorise sums by itself, since the order of the additions
/// changes the round-off error.
namespace fpbm {

/// Σ a_i b_i over n entries.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline Scalar column_dot(const Scalar* a, const Scalar* b, Eigen::Index n) noexcept {
  Eigen::Index i = 0;
  Scalar sum(0);
  if constexpr (kRowsInPairs<Scalar>) {
    using Two = Pair<Scalar>;
    Two even(Scalar(0));
    Two odd(Scalar(0));
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC unroll 8
#endif
    for (; i + 4 <= n; i += 4) {
      even += Two::load(a + i) * Two::load(b + i);
      odd += Two::load(a + i + 2) * Two::load(b + i + 2);
    }
    if (i + 2 <= n) {
      even += Two::load(a + i) * Two::load(b + i);
      i += 2;
    }
    even += odd;
    sum = even.first() + even.second();
  }
  for (; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// Σ a_i² over n entries.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline Scalar squared_length(const Scalar* a, Eigen::Index n) noexcept {
  return column_dot(a, a, n);
}

/// a −= s b over n entries.
template <typename Scalar>
[[gnu::always_inline]] inline void subtract_multiple(Scalar* a, Scalar s, const Scalar* b, Eigen::Index n) noexcept {
  Eigen::Index i = 0;
  if constexpr (kRowsInPairs<Scalar>) {
    using Two = Pair<Scalar>;
    const Two factor(s);
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC unroll 8
#endif
    for (; i + 2 <= n; i += 2) (Two::load(a + i) - factor * Two::load(b + i)).store(a + i);
  }
  for (; i < n; ++i) a[i] -= s * b[i];
}

/// a and b become c a − s b and s a + c b, over n entries.
template <typename Scalar>
[[gnu::always_inline]] inline void rotate(Scalar* a, Scalar* b, Scalar c, Scalar s, Eigen::Index n) noexcept {
  Eigen::Index i = 0;
  if constexpr (kRowsInPairs<Scalar>) {
    using Two = Pair<Scalar>;
    for (; i + 2 <= n; i += 2) {
      const Two x = Two::load(a + i);
      const Two y = Two::load(b + i);
      (Two(c) * x - Two(s) * y).store(a + i);
      (Two(s) * x + Two(c) * y).store(b + i);
    }
  }
  for (; i < n; ++i) {
    const Scalar x = a[i];
    a[i] = c * x - s * b[i];
    b[i] = s * x + c * b[i];
  }
}

}  // namespace fpbm
