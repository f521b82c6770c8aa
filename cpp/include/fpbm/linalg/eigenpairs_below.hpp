#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/core/unrolled.hpp"
#include "fpbm/linalg/pair.hpp"
#include "fpbm/linalg/paired.hpp"
#include "fpbm/linalg/product.hpp"

namespace fpbm {

/// The eigenvalues of a small symmetric matrix below a bound, unordered, and their orthonormal eigenvectors.
///
/// Reflections make A tridiagonal (Golub and Van Loan, Matrix Computations, 8.3). A Sturm sequence counts the
/// eigenvalues below the bound. QL steps isolate one eigenvalue after the other until so many are found: the first step
/// with shift 0, which favours the eigenvalue nearest to zero, the others with Wilkinson's. At most kSteps steps for
/// each eigenvalue, usually three. Accurate to round-off in ‖A‖.
template <int M, typename Scalar = double>
class EigenpairsBelow {
 public:
  using Column = Vector<M, Scalar>;

  /// A: its lower triangle is read. Where A is not finite, one eigenvalue is NaN.
  EigenpairsBelow(const Matrix<M, M, Scalar>& A, Scalar bound) noexcept
      : T_(A),
        values_(filled<Column>(A.rows())),
        beside_(values_),
        shares_(values_),
        vectors_(identity<Matrix<M, M, Scalar>>(A.rows())) {
    const auto m = extent<M>(A.rows());
    Scalar zero(0);  // NaN if an entry is not finite.
    for (Eigen::Index j = 0; j < m; ++j) {
      for (Eigen::Index i = j; i < m; ++i) {
        size_ = std::max(size_, std::abs(A(i, j)));
        zero += A(i, j) * Scalar(0);
      }
    }
    if (!(zero == Scalar(0))) {
      values_(0) = zero;
      found_ = 1;
      return;
    }
    // Squares of round-off errors must be in range. A scale adds a round-off error, hence none if they are.
    const bool in_range = size_ > kLeast && size_ < Scalar(1) / kLeast;
    if (!in_range && size_ > Scalar(0)) scale_ = size_;
    const Scalar inverse = Scalar(1) / scale_;
    size_ *= inverse;
    for (Eigen::Index j = 0; j < m; ++j) {
      for (Eigen::Index i = j; i < m; ++i) T_(j, i) = T_(i, j) *= inverse;
    }
    make_tridiagonal();
    const Scalar least = bound * inverse;
    const int count = count_below(least);
    int below = 0;
    while (below < count && found_ < m) {
      isolate(found_);
      below += values_(found_++) < least ? 1 : 0;
    }
  }

  /// Number of eigenvalues that were isolated: all below the bound, and perhaps others.
  [[nodiscard]] Eigen::Index count() const noexcept { return found_; }
  [[nodiscard]] Scalar value(Eigen::Index k) const noexcept { return values_(k) * scale_; }

  /// Eigenvector k.
  [[nodiscard]] Column vector(Eigen::Index k) const noexcept {
    const Eigen::Index m = values_.size();
    Column v = fpbm::column(vectors_, k);
    for (Eigen::Index i = m - 2; i-- > 0;) {
      const Scalar* const reflection = T_.data() + i * m;
      subtract_multiple(v.data(), shares_(i) * paired_dot(reflection, v.data(), m), reflection, m);
    }
    return v;
  }

 private:
  static constexpr int kSteps = 30;  // As in EISPACK's tql2.
  /// More than 100 √(min/ε)/ε of the Scalar: round-off errors of such a matrix still have squares with all digits.
  static constexpr Scalar kLeast = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-128) : Scalar(1e-6);

  /// T ← HᵀTH, tridiagonal, H a product of reflections I − share v vᵀ: values on the diagonal, beside(i) between i and
  /// i + 1. Column k of T becomes v of reflection k.
  void make_tridiagonal() noexcept {
    const auto m = extent<M>(T_.rows());
    const auto column = [&](Eigen::Index j) noexcept { return T_.data() + j * m; };
    for (Eigen::Index k = 0; k + 2 < m; ++k) {
      Scalar* const v = column(k);
      values_(k) = v[k];
      for (Eigen::Index i = 0; i <= k; ++i) v[i] = Scalar(0);
      beside_(k) = v[k + 1];
      const Scalar below = squared_length(v + k + 2, m - k - 2);
      if (!(below > Scalar(0))) continue;
      const Scalar length = std::sqrt(v[k + 1] * v[k + 1] + below);
      shares_(k) = Scalar(1) / (length * (length + std::abs(v[k + 1])));
      beside_(k) = v[k + 1] > Scalar(0) ? -length : length;
      v[k + 1] -= beside_(k);
      Column w = filled<Column>(m);
      for (Eigen::Index j = k + 1; j < m; ++j) subtract_multiple(w.data(), -shares_(k) * v[j], column(j), m);
      subtract_multiple(w.data(), shares_(k) / Scalar(2) * paired_dot(v, w.data(), m), v, m);
      for (Eigen::Index j = k + 1; j < m; ++j) {
        subtract_multiple(column(j), w(j), v, m);
        subtract_multiple(column(j), v[j], w.data(), m);
      }
    }
    for (Eigen::Index k = std::max<Eigen::Index>(m - 2, 0); k < m; ++k) values_(k) = T_(k, k);
    if (m > 1) beside_(m - 2) = T_(m - 1, m - 2);
  }

  /// Number of eigenvalues of the tridiagonal matrix below a bound: of negative pivots, by Sylvester's law.
  [[nodiscard]] int count_below(Scalar bound) const noexcept {
    int count = 0;
    Scalar pivot(1);
    for (Eigen::Index i = 0; i < values_.size(); ++i) {
      const Scalar coupling = i > 0 ? beside_(i - 1) : Scalar(0);
      pivot = values_(i) - bound - coupling * coupling / pivot;
      if (pivot == Scalar(0)) pivot = -std::numeric_limits<Scalar>::min();
      count += pivot < Scalar(0) ? 1 : 0;
    }
    return count;
  }

  /// QL steps until beside(first) is negligible.
  void isolate(Eigen::Index first) noexcept {
    using std::abs;
    using std::sqrt;
    const Scalar negligible = std::numeric_limits<Scalar>::epsilon() * size_;
    for (int step = 0; step < kSteps; ++step) {
      Eigen::Index last = first;
      while (last + 1 < values_.size() && abs(beside_(last)) > negligible) ++last;
      if (last == first) return;
      if (step == 0 && last > first + 1) {
        step_from(last, first, Scalar(0));
        continue;
      }
      const Scalar theta = (values_(first + 1) - values_(first)) / (Scalar(2) * beside_(first));
      const Scalar tangent =
          (theta < Scalar(0) ? Scalar(-1) : Scalar(1)) / (abs(theta) + sqrt(theta * theta + Scalar(1)));
      const Scalar change = tangent * beside_(first);
      if (last == first + 1) {
        const Scalar c = Scalar(1) / sqrt(tangent * tangent + Scalar(1));
        rotate(first, c, tangent * c);
        values_(first) -= change;
        values_(last) += change;
        beside_(first) = Scalar(0);
        return;
      }
      step_from(last, first, values_(first) - change);
    }
  }

  /// One QL step on the entries from first to last.
  void step_from(Eigen::Index last, Eigen::Index first, Scalar shift) noexcept {
    Scalar g = values_(last) - shift;
    Scalar s(1);
    Scalar c(1);
    Scalar change(0);
    for (Eigen::Index i = last; i-- > first;) {
      const Scalar f = s * beside_(i);
      const Scalar b = c * beside_(i);
      const Scalar length = std::sqrt(f * f + g * g);
      beside_(i + 1) = length;
      if (!(length > Scalar(0))) {  // The matrix falls apart here.
        values_(i + 1) -= change;
        beside_(last) = Scalar(0);
        return;
      }
      const Scalar inverse = Scalar(1) / length;
      s = f * inverse;
      c = g * inverse;
      const Scalar value = values_(i + 1) - change;
      const Scalar r = (values_(i) - value) * s + Scalar(2) * c * b;
      change = s * r;
      values_(i + 1) = value + change;
      g = c * r - b;
      rotate(i, c, s);
    }
    values_(first) -= change;
    beside_(first) = g;
    beside_(last) = Scalar(0);
  }

  /// Vectors i and i + 1 become c vᵢ − s vᵢ₊₁ and s vᵢ + c vᵢ₊₁.
  void rotate(Eigen::Index i, Scalar c, Scalar s) noexcept {
    const auto m = extent<M>(vectors_.rows());
    Scalar* const a = vectors_.data() + i * m;
    Scalar* const b = a + m;
    const Eigen::Index paired = kRowsInPairs<Scalar> ? m - m % 2 : 0;
    for (Eigen::Index k = 0; k < paired; k += 2) {
      using Two = Pair<Scalar>;
      const Two x = Two::load(a + k);
      const Two y = Two::load(b + k);
      (Two(c) * x - Two(s) * y).store(a + k);
      (Two(s) * x + Two(c) * y).store(b + k);
    }
    for (Eigen::Index k = paired; k < m; ++k) {
      const Scalar x = a[k];
      a[k] = c * x - s * b[k];
      b[k] = s * x + c * b[k];
    }
  }

  Matrix<M, M, Scalar> T_;  ///< A/scale, then the reflections.
  Column values_;           ///< Of A/scale.
  Column beside_;
  Column shares_;
  Matrix<M, M, Scalar> vectors_;  ///< Of the tridiagonal matrix.
  Scalar size_{0};                ///< Largest entry of A/scale.
  Scalar scale_{1};
  Eigen::Index found_ = 0;
};

}  // namespace fpbm
