#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/total.hpp"

/// Sums and maxima over the entries of a non-empty matrix, by loops.
///
/// A loop compiles faster than an Eigen reduction, which instantiates about twenty classes and functions for each
/// expression type, and another function for each entry of a fixed-size matrix.
namespace fpbm {

/// Σ f(i) over the entries of a matrix. Sums of up to four terms are written out, so that a compiler keeps them in
/// registers. Limits of 1 to 7 terms give the same time for a step of a position task of a Panda (g++ 12, -O2).
template <typename Plain, typename F>
[[nodiscard]] auto sum_over(const Eigen::PlainObjectBase<Plain>& size, const F& f) noexcept {
  constexpr int kFew = 4;
  if constexpr (Plain::SizeAtCompileTime != Eigen::Dynamic && Plain::SizeAtCompileTime <= kFew) {
    return total<0, Plain::SizeAtCompileTime>(f);
  } else {
    auto sum = f(0);
    for (Eigen::Index i = 1; i < size.size(); ++i) sum += f(i);
    return sum;
  }
}

template <typename Plain>
[[nodiscard]] typename Plain::Scalar squared_norm(const Eigen::PlainObjectBase<Plain>& A) noexcept {
  return sum_over(A, [&](Eigen::Index i) { return A.coeff(i) * A.coeff(i); });
}

template <typename Plain>
[[nodiscard]] typename Plain::Scalar norm(const Eigen::PlainObjectBase<Plain>& A) noexcept {
  using std::sqrt;
  return sqrt(squared_norm(A));
}

template <typename Plain>
[[nodiscard]] typename Plain::Scalar dot(const Eigen::PlainObjectBase<Plain>& a,
                                         const Eigen::PlainObjectBase<Plain>& b) noexcept {
  return sum_over(a, [&](Eigen::Index i) { return a.coeff(i) * b.coeff(i); });
}

/// Largest magnitude of an entry.
template <typename Plain>
[[nodiscard]] typename Plain::Scalar largest_magnitude(const Eigen::PlainObjectBase<Plain>& A) noexcept {
  using std::abs;
  typename Plain::Scalar largest(0);
  for (Eigen::Index i = 0; i < A.size(); ++i) largest = std::max(largest, abs(A.coeff(i)));
  return largest;
}

/// Whether all entries are finite. Always true with lanes, where a failed lane does not disturb the other lanes.
template <typename Plain>
[[nodiscard]] bool is_finite([[maybe_unused]] const Eigen::PlainObjectBase<Plain>& values) noexcept {
  using Scalar = typename Plain::Scalar;
  if constexpr (kInLanes<Scalar>) {
    return true;
  } else {
    Scalar product(0);  // Inf and NaN make the product NaN.
    each(Constant<0>{}, extent<Plain::SizeAtCompileTime>(values.size()),
         [&](Eigen::Index i) { product *= values.coeff(i); });
    return product == Scalar(0);
  }
}

}  // namespace fpbm
