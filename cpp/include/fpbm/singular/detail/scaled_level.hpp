#pragma once

#include <cmath>

#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/diagonal_level.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/lower_gram.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Rows J u = r of a task level, scaled so that a singular value of J Z is the fraction of a task direction that is in
/// the null space of the higher levels. Z is an orthonormal basis of the null space of the higher levels:
///
///   C⁻¹J u = C⁻¹r,   C Cᵀ = J Jᵀ + (ρ ‖J‖_F)² I,   C lower triangular.
///
/// With ρ = 0, the rows C⁻¹J are orthonormal, and the singular values of C⁻¹J Z are the cosines of the principal angles
/// between the row space of J and the null space: 1 if the higher levels leave a direction free, 0 if the higher levels
/// determine the direction, for any unit of the rows. With ρ > 0, a direction in which J has the singular value σ has
/// at most the singular value σ/√(σ² + ρ²‖J‖²_F) of C⁻¹J Z, so that directions are also lost at singular postures.
template <int M, int N, typename Scalar>
struct ScaledLevel {
  Matrix<M, N, Scalar> J;
  Vector<M, Scalar> r;

  /// If J is zero or not finite, the rows are not scaled.
  ScaledLevel(const Matrix<M, N, Scalar>& rows, const Vector<M, Scalar>& right) noexcept : J(rows), r(right) {
    if constexpr (M == N || M == Eigen::Dynamic || N == Eigen::Dynamic) {
      if (is_diagonal(J)) {
        const Vector<M, Scalar> scales = scales_of(entrywise(r, [&](Eigen::Index i) { return J.coeff(i, i); }));
        for (Eigen::Index i = 0; i < J.rows(); ++i) {
          J.coeffRef(i, i) *= scales.coeff(i);
          r.coeffRef(i) *= scales.coeff(i);
        }
        return;
      }
    }
    Matrix<M, M, Scalar> gram = lower_gram(J);
    Scalar squares(0);  // ‖J‖²_F
    for (Eigen::Index i = 0; i < gram.rows(); ++i) squares += gram.coeff(i, i);
    for (Eigen::Index i = 0; i < gram.rows(); ++i) gram.coeffRef(i, i) += kPosture * kPosture * squares;
    Cholesky<M, Scalar> cholesky;
    if (cholesky.factor(gram) != Status::kOk) return;
    cholesky.orthonormalize(J, r);
  }

  /// C⁻¹ of a diagonal J.
  [[nodiscard]] static Vector<M, Scalar> scales_of(const Vector<M, Scalar>& entries) noexcept {
    const Scalar least = kPosture * kPosture * squared_norm(entries);
    return entrywise(
        entries, [&](Eigen::Index i) { return Scalar(1) / std::sqrt(entries.coeff(i) * entries.coeff(i) + least); });
  }

 private:
  /// ρ. With the radius 0.1 of lower levels (kLevelRadius), a direction is lost at σ = 0.03 ‖J‖_F because of the
  /// posture. Source of the value: 120 trials in which the target of a position task of a Panda, one level below an
  /// axis task, leaves the workspace and returns. The tip reaches 115 of the 120 targets again; 108 with ρ = 0.1, 111
  /// with 0.2, 115 with 0.6, 110 with 1. `FPBM_ALL_TRIALS=1 fpbm_tests --gtest_filter=LowerLevels.reach*` prints the
  /// number of targets.
  static constexpr Scalar kPosture = Scalar(0.3);
};

/// ScaledLevel for a posture of all joints.
template <int N, typename Scalar>
struct ScaledDiagonal {
  DiagonalLevel<N, Scalar> J;
  Vector<N, Scalar> r;

  ScaledDiagonal(const DiagonalLevel<N, Scalar>& rows, const Vector<N, Scalar>& right) noexcept {
    const Vector<N, Scalar> scales = ScaledLevel<N, N, Scalar>::scales_of(rows.entries);
    J = {product(rows, scales)};
    r = entrywise(right, [&](Eigen::Index i) { return right.coeff(i) * scales.coeff(i); });
  }
};

template <int M, int N, typename Scalar>
[[nodiscard]] ScaledLevel<M, N, Scalar> scaled_level(const Matrix<M, N, Scalar>& J,
                                                     const Vector<M, Scalar>& r) noexcept {
  return {J, r};
}
template <int N, typename Scalar>
[[nodiscard]] ScaledDiagonal<N, Scalar> scaled_level(const DiagonalLevel<N, Scalar>& J,
                                                     const Vector<N, Scalar>& r) noexcept {
  return {J, r};
}

}  // namespace fpbm
