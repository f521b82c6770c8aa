#pragma once

#include <algorithm>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/product.hpp"

namespace fpbm {

/// Lower triangle of JJᵀ, computed two rows at a time. Some entries above the diagonal are not set.
template <int M, int N, typename Scalar>
[[nodiscard]] Matrix<M, M, Scalar> lower_gram(const Matrix<M, N, Scalar>& J) noexcept {
  if constexpr (M == Eigen::Dynamic) {
    return gram_of(J);
  } else {
    using Two = Pair<Scalar>;
    constexpr Constant<0> kFirst{};
    constexpr Constant<(M + 1) / 2> kPairs{};
    Two sums[kPairs][M];  // Entries of rows 2i and 2i + 1.
    const auto each_sum = [&](auto i, const auto& f) {
      each(kFirst, Constant<std::min<Eigen::Index>(2 * decltype(i)::kIndex + 2, M)>{}, f);
    };
    each(kFirst, kPairs, [&](auto i) { each_sum(i, [&](Eigen::Index j) { sums[i][j] = Two(Scalar(0)); }); });
    for (Eigen::Index k = 0; k < J.cols(); ++k) {
      const Scalar* const column = J.data() + M * k;
      each(kFirst, kPairs, [&](auto i) {
        const Two two = 2 * i + 1 < M ? Two::load(column + 2 * i) : Two(column[M - 1], Scalar(0));
        each_sum(i, [&](Eigen::Index j) { sums[i][j] += two * Two(column[j]); });
      });
    }
    Matrix<M, M, Scalar> gram;
    each(kFirst, kPairs, [&](auto i) {
      each_sum(i, [&](Eigen::Index j) {
        gram.coeffRef(2 * i, j) = sums[i][j].first();
        if (2 * i + 1 < M) gram.coeffRef(2 * i + 1, j) = sums[i][j].second();
      });
    });
    return gram;
  }
}

}  // namespace fpbm
