#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/tridiagonal.hpp"

namespace fpbm {

/// Eigenvalues of a small symmetric matrix A below a bound, unordered, and their orthonormal eigenvectors.
///
/// Householder reflections make A tridiagonal (Golub and Van Loan, Matrix Computations, 8.3). A Sturm sequence counts
/// the eigenvalues below the bound. QL steps isolate one eigenvalue after another until all eigenvalues below the bound
/// are found. The first step has the shift 0, which favours the eigenvalue nearest to zero; the other steps have
/// Wilkinson's shift. Each eigenvalue needs at most 30 steps, usually three. Accurate to round-off in ‖A‖. With
/// Eigen's SelfAdjointEigenSolver instead, `make count` prints 23,594 instead of 13,397 instructions for
/// step/panda/pose/fpbm_damped_singular.
template <int M, typename Scalar = double>
class EigenpairsBelow {
 public:
  using Column = Vector<M, Scalar>;

  /// Reads the lower triangle of A. If A is not finite, one eigenvalue is NaN.
  EigenpairsBelow(const Matrix<M, M, Scalar>& A, Scalar bound) noexcept
      : T_(A), tridiagonal_(A.rows()), factors_(filled<Column>(A.rows())) {
    const auto m = extent<M>(A.rows());
    Scalar zero(0);  // NaN if an entry is not finite.
    for (Eigen::Index j = 0; j < m; ++j) {
      for (Eigen::Index i = j; i < m; ++i) {
        tridiagonal_.size = std::max(tridiagonal_.size, std::abs(A(i, j)));
        zero += A(i, j) * Scalar(0);
      }
    }
    if (!(zero == Scalar(0))) {
      tridiagonal_.values(0) = zero;
      found_ = 1;
      return;
    }
    // Squares of round-off errors must be in the range of the Scalar. Scaling adds a round-off error and is therefore
    // omitted if the squares are in range.
    const bool in_range = tridiagonal_.size > kLeast && tridiagonal_.size < Scalar(1) / kLeast;
    if (!in_range && tridiagonal_.size > Scalar(0)) scale_ = tridiagonal_.size;
    const Scalar inverse = Scalar(1) / scale_;
    tridiagonal_.size *= inverse;
    for (Eigen::Index j = 0; j < m; ++j) {
      for (Eigen::Index i = j; i < m; ++i) T_(j, i) = T_(i, j) *= inverse;
    }
    make_tridiagonal();
    const Scalar least = bound * inverse;
    const int count = tridiagonal_.count_below(least);
    int below = 0;
    while (below < count && found_ < m) {
      tridiagonal_.isolate(found_);
      below += tridiagonal_.values(found_++) < least ? 1 : 0;
    }
  }

  /// Number of isolated eigenvalues: all below the bound, and perhaps others.
  [[nodiscard]] Eigen::Index count() const noexcept { return found_; }
  [[nodiscard]] Scalar value(Eigen::Index k) const noexcept { return tridiagonal_.values(k) * scale_; }

  /// Eigenvector k.
  [[nodiscard]] Column vector(Eigen::Index k) const noexcept {
    const Eigen::Index m = tridiagonal_.values.size();
    Column v = fpbm::column(tridiagonal_.vectors, k);
    for (Eigen::Index i = m - 2; i-- > 0;) {
      const Scalar* const reflection = T_.data() + i * m;
      subtract_multiple(v.data(), factors_(i) * column_dot(reflection, v.data(), m), reflection, m);
    }
    return v;
  }

 private:
  /// Larger than 100 √(min/ε)/ε with the smallest normal number min: 4e-129 for double, 3e-7 for float. If the largest
  /// entry is above kLeast, the squares of round-off errors keep all digits.
  static constexpr Scalar kLeast = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-128) : Scalar(1e-6);

  /// T ← HᵀTH makes T tridiagonal, where H is a product of reflections I − factor v vᵀ. values: the diagonal;
  /// beside(i): entry (i + 1, i). Column k of T becomes v of reflection k.
  void make_tridiagonal() noexcept {
    const auto m = extent<M>(T_.rows());
    const auto column = [&](Eigen::Index j) noexcept { return T_.data() + j * m; };
    for (Eigen::Index k = 0; k + 2 < m; ++k) {
      Scalar* const v = column(k);
      tridiagonal_.values(k) = v[k];
      for (Eigen::Index i = 0; i <= k; ++i) v[i] = Scalar(0);
      tridiagonal_.beside(k) = v[k + 1];
      const Scalar below = squared_length(v + k + 2, m - k - 2);
      if (!(below > Scalar(0))) continue;
      const Scalar length = std::sqrt(v[k + 1] * v[k + 1] + below);
      factors_(k) = Scalar(1) / (length * (length + std::abs(v[k + 1])));
      tridiagonal_.beside(k) = v[k + 1] > Scalar(0) ? -length : length;
      v[k + 1] -= tridiagonal_.beside(k);
      Column w = filled<Column>(m);
      for (Eigen::Index j = k + 1; j < m; ++j) subtract_multiple(w.data(), -factors_(k) * v[j], column(j), m);
      subtract_multiple(w.data(), factors_(k) / Scalar(2) * column_dot(v, w.data(), m), v, m);
      for (Eigen::Index j = k + 1; j < m; ++j) {
        subtract_multiple(column(j), w(j), v, m);
        subtract_multiple(column(j), v[j], w.data(), m);
      }
    }
    for (Eigen::Index k = std::max<Eigen::Index>(m - 2, 0); k < m; ++k) tridiagonal_.values(k) = T_(k, k);
    if (m > 1) tridiagonal_.beside(m - 2) = T_(m - 1, m - 2);
  }

  Matrix<M, M, Scalar> T_;              ///< A/scale, then the vectors v of the reflections.
  Tridiagonal<M, Scalar> tridiagonal_;  ///< Tridiagonal form of A/scale.
  Column factors_;
  Scalar scale_{1};
  Eigen::Index found_ = 0;
};

}  // namespace fpbm
