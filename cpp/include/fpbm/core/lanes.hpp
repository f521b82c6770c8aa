#pragma once

#include <Eigen/Core>
#include <experimental/simd>

/// K numbers in the lanes of SIMD registers. With Scalar = Lanes<K>, the same code computes K arms, or K motions of an
/// arm, in parallel. core/detail/mask.hpp describes the replacement for branches.
namespace fpbm {

template <int K, typename T = double>
using Lanes = std::experimental::simd<T, std::experimental::simd_abi::deduce_t<T, K>>;

}  // namespace fpbm

template <typename T, typename Abi>
struct Eigen::NumTraits<std::experimental::simd<T, Abi>> : Eigen::GenericNumTraits<std::experimental::simd<T, Abi>> {
  using Self = std::experimental::simd<T, Abi>;
  using Real = Self;
  using NonInteger = Self;
  using Literal = Self;
  using Nested = Self;
  // NOLINTBEGIN(readability-identifier-naming): Eigen's names.
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
  // NOLINTEND(readability-identifier-naming)
};

/// Operations between a number and lanes, for example a product.
template <typename T, typename Abi, typename Operation>
struct Eigen::ScalarBinaryOpTraits<T, std::experimental::simd<T, Abi>, Operation> {
  using ReturnType = std::experimental::simd<T, Abi>;
};
