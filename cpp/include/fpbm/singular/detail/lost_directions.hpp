#pragma once

#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/eigenpairs_below.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Nearly lost task directions of an arm, and the damping Δ in these directions (docs/singularities.md, Damping law).
///
/// For G = JJᵀ with eigenvalues σᵢ² and eigenvectors uᵢ,
///
///   Δ = Σ δ(σᵢ) uᵢuᵢᵀ,   δ(σ) = ε² (1 − σ²/ε²)³ for σ < ε, otherwise 0
///
/// (numerical filtering: Maciejewski and Klein 1988; Chiaverini 1997). Δ is a spectral function of G with two
/// continuous derivatives, and therefore smooth in q. G + Δ has no eigenvalue below 0.61 ε², and ‖Jᵀ(JJᵀ + Δ)⁻¹‖ ≤
/// 1.17/ε.
template <int M, typename Scalar>
struct LostDirections {
  Scalar count{0};  ///< tr Δ/ε², about the number of lost directions.
  Scalar fade{1};  ///< Π φ(σᵢ/(kFade ε)), φ(s) = 1 − (1 − s²)³ for s < 1, otherwise 1. 0 in a singular posture.
  Matrix<M, M, Scalar> delta;  ///< Δ

  /// gram: G. Only the lower triangle is read. rows: J. N: number of columns of J.
  template <int N>
  LostDirections(const Matrix<M, M, Scalar>& gram, const Matrix<M, N, Scalar>& rows, Scalar epsilon_squared) noexcept
      : delta(filled<Matrix<M, M, Scalar>>(gram.rows())) {
    if (none_is_lost(gram, epsilon_squared)) return;
    const EigenpairsBelow<M, Scalar> lost(gram, epsilon_squared);
    for (Eigen::Index i = 0; i < lost.count(); ++i) {
      if (!(lost.value(i) < epsilon_squared)) continue;
      const Vector<M, Scalar> u = lost.vector(i);
      // σ = ‖Jᵀu‖ has the round-off error ε_machine ‖J‖. The eigenvalue has the round-off error ε_machine ‖J‖², and σ
      // from the eigenvalue would have √ε_machine ‖J‖.
      const Scalar gap = Scalar(1) - squared_motion(rows, u) / epsilon_squared;
      if (!(gap > Scalar(0))) continue;
      const Scalar weight = gap < Scalar(1) ? gap * gap * gap : Scalar(1);
      for (Eigen::Index j = 0; j < gram.rows(); ++j) {
        subtract_multiple(delta.data() + j * gram.rows(), -weight * epsilon_squared * u(j), u.data(), gram.rows());
      }
      count += weight;
      const Scalar near = Scalar(1) - (Scalar(1) - gap) / (kFade * kFade);
      if (near > Scalar(0)) fade *= near < Scalar(1) ? Scalar(1) - near * near * near : Scalar(0);
    }
  }

 private:
  /// Fraction of ε below which secondary motion fades, less than 1 so that φ has two continuous derivatives where
  /// damping begins. While φ < 1, secondary motion hardly leads an arm away from a singular posture: with 1,
  /// test_unreachable_target_stops_and_returns in Python stays near the outstretched posture, and returns by a
  /// recovery; with 0.1 and less, it returns by itself. Secondary motion turns within kFade ε: a smaller value makes it
  /// steeper.
  static constexpr Scalar kFade = Scalar(0.1);

  /// ‖Jᵀu‖².
  template <int N>
  [[nodiscard]] static Scalar squared_motion(const Matrix<M, N, Scalar>& rows, const Vector<M, Scalar>& u) noexcept {
    return squared_norm(transpose_times(rows, u));
  }

  /// Whether G − ε²I is positive definite, so that all σᵢ are above ε. Takes a small fraction of the time for the
  /// eigenvectors.
  [[nodiscard]] static bool none_is_lost(Matrix<M, M, Scalar> gram, Scalar epsilon_squared) noexcept {
    for (Eigen::Index i = 0; i < gram.rows(); ++i) gram.coeffRef(i, i) -= epsilon_squared;
    Cholesky<M, Scalar> cholesky;
    return cholesky.factor(gram) == Status::kOk;
  }
};

}  // namespace fpbm
