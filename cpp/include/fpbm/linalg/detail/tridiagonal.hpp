#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"

namespace fpbm {

/// Symmetric tridiagonal matrix T. QL steps make T diagonal. values: the diagonal; beside(i): entry (i + 1, i). The
/// initial matrix is V T Vᵀ with the orthonormal vectors V (Golub and Van Loan, Matrix Computations, 8.3).
template <int M, typename Scalar>
struct Tridiagonal {
  using Column = Vector<M, Scalar>;

  explicit Tridiagonal(Eigen::Index m) noexcept
      : values(filled<Column>(m)), beside(values), vectors(identity<Matrix<M, M, Scalar>>(m)) {}

  Column values;
  Column beside;
  Matrix<M, M, Scalar> vectors;
  Scalar size{0};  ///< Largest magnitude of an entry of the initial matrix.

  /// Number of eigenvalues below a bound, which is the number of negative pivots of T − bound I (Sylvester's law of
  /// inertia).
  [[nodiscard]] int count_below(Scalar bound) const noexcept {
    int count = 0;
    Scalar pivot(1);
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const Scalar coupling = i > 0 ? beside(i - 1) : Scalar(0);
      pivot = values(i) - bound - coupling * coupling / pivot;
      if (pivot == Scalar(0)) pivot = -std::numeric_limits<Scalar>::min();
      count += pivot < Scalar(0) ? 1 : 0;
    }
    return count;
  }

  /// Applies QL steps until beside(first) is negligible: below the round-off error ε ‖T‖ of the result. Factors of 1 to
  /// 10 pass `*EigenpairsBelowOf*`; 0.1 and 100 fail.
  void isolate(Eigen::Index first) noexcept {
    using std::abs;
    using std::sqrt;
    const Scalar negligible = std::numeric_limits<Scalar>::epsilon() * size;
    for (int step = 0; step < kSteps; ++step) {
      Eigen::Index last = first;
      while (last + 1 < values.size() && abs(beside(last)) > negligible) ++last;
      if (last == first) return;
      if (step == 0 && last > first + 1) {
        step_from(last, first, Scalar(0));
        continue;
      }
      const Scalar theta = (values(first + 1) - values(first)) / (Scalar(2) * beside(first));
      const Scalar tangent =
          (theta < Scalar(0) ? Scalar(-1) : Scalar(1)) / (abs(theta) + sqrt(theta * theta + Scalar(1)));
      const Scalar change = tangent * beside(first);
      if (last == first + 1) {
        const Scalar c = Scalar(1) / sqrt(tangent * tangent + Scalar(1));
        turn(first, c, tangent * c);
        values(first) -= change;
        values(last) += change;
        beside(first) = Scalar(0);
        return;
      }
      step_from(last, first, values(first) - change);
    }
  }

 private:
  static constexpr int kSteps = 30;  // As in EISPACK's tql2. With 6, `*EigenpairsBelowOf*` passes; with 3, fails.

  /// One QL step on the entries from first to last.
  void step_from(Eigen::Index last, Eigen::Index first, Scalar shift) noexcept {
    Scalar g = values(last) - shift;
    Scalar s(1);
    Scalar c(1);
    Scalar change(0);
    for (Eigen::Index i = last; i-- > first;) {
      const Scalar f = s * beside(i);
      const Scalar b = c * beside(i);
      const Scalar length = std::sqrt(f * f + g * g);
      beside(i + 1) = length;
      if (!(length > Scalar(0))) {  // The matrix decouples here.
        values(i + 1) -= change;
        beside(last) = Scalar(0);
        return;
      }
      const Scalar inverse = Scalar(1) / length;
      s = f * inverse;
      c = g * inverse;
      const Scalar value = values(i + 1) - change;
      const Scalar r = (values(i) - value) * s + Scalar(2) * c * b;
      change = s * r;
      values(i + 1) = value + change;
      g = c * r - b;
      turn(i, c, s);
    }
    values(first) -= change;
    beside(first) = g;
    beside(last) = Scalar(0);
  }

  /// Vectors i and i + 1 become c vᵢ − s vᵢ₊₁ and s vᵢ + c vᵢ₊₁.
  void turn(Eigen::Index i, Scalar c, Scalar s) noexcept {
    const auto m = extent<M>(vectors.rows());
    rotate(vectors.data() + i * m, vectors.data() + (i + 1) * m, c, s, m);
  }
};

}  // namespace fpbm
