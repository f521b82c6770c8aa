#pragma once

#include <type_traits>

namespace fpbm {

/// Two Scalars with entrywise arithmetic. Always inlined: with -Os, GCC would call every operator.
template <typename Scalar>
struct PlainPair {
  Scalar a;
  Scalar b;

  [[nodiscard]] const Scalar& operator[](int i) const noexcept { return i == 0 ? a : b; }
  [[gnu::always_inline]] friend PlainPair operator+(const PlainPair& x, const PlainPair& y) noexcept {
    return {x.a + y.a, x.b + y.b};
  }
  [[gnu::always_inline]] friend PlainPair operator-(const PlainPair& x, const PlainPair& y) noexcept {
    return {x.a - y.a, x.b - y.b};
  }
  [[gnu::always_inline]] friend PlainPair operator*(const PlainPair& x, const PlainPair& y) noexcept {
    return {x.a * y.a, x.b * y.b};
  }
  [[gnu::always_inline]] friend PlainPair operator/(const PlainPair& x, const PlainPair& y) noexcept {
    return {x.a / y.a, x.b / y.b};
  }
};

/// Storage of a Pair: one SIMD vector if the compiler has vector types, else a PlainPair. For a processor without
/// vector registers, for example a Cortex-M, GCC would keep vectors in memory.
template <typename Scalar, typename = void>
struct PairStorage {
  using type = PlainPair<Scalar>;
};
// __GNUC__ is also defined by compilers compatible with GNU C++.
#if defined(__GNUC__) && (!defined(__arm__) || defined(__ARM_NEON))
template <typename Scalar>
struct PairStorage<Scalar, std::enable_if_t<std::is_arithmetic_v<Scalar> && sizeof(Scalar) <= sizeof(double)>> {
  using type [[gnu::vector_size(2 * sizeof(Scalar))]] = Scalar;
};
#endif

}  // namespace fpbm
