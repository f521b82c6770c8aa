#pragma once

#include <cmath>

#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/diagonal_level.hpp"
#include "fpbm/linalg/entrywise.hpp"
#include "fpbm/linalg/lower_gram.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// Rows J u = r of a task level in units in which a singular value of J Z says what the higher levels leave of a task
/// direction, where Z is a basis of their null space:
///
///   C⁻¹J u = C⁻¹r,   C Cᵀ = J Jᵀ + (ρ ‖J‖_F)² I,   C lower triangular.
///
/// Without ρ, the rows C⁻¹J are orthonormal, and the singular values of C⁻¹J Z are the cosines of the principal angles
/// between the row space of J and the null space: 1 where the higher levels leave a direction free, 0 where they
/// determine it, in any unit of the rows. With ρ, a direction in which J has the singular value σ counts at most
/// σ/√(σ² + ρ²‖J‖²_F): it is lost in singular postures too.
template <int M, int N, typename Scalar>
struct ScaledLevel {
  Matrix<M, N, Scalar> J;
  Vector<M, Scalar> r;

  /// The rows stay as they are where J is zero or not finite.
  ScaledLevel(const Matrix<M, N, Scalar>& rows, const Vector<M, Scalar>& right) noexcept : J(rows), r(right) {
    if constexpr (M == N || M == Eigen::Dynamic || N == Eigen::Dynamic) {
      if (is_diagonal(J)) {
        const Vector<M, Scalar> shares = shares_of(entrywise(r, [&](Eigen::Index i) { return J.coeff(i, i); }));
        for (Eigen::Index i = 0; i < J.rows(); ++i) {
          J.coeffRef(i, i) *= shares.coeff(i);
          r.coeffRef(i) *= shares.coeff(i);
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
  [[nodiscard]] static Vector<M, Scalar> shares_of(const Vector<M, Scalar>& entries) noexcept {
    const Scalar least = kPosture * kPosture * squared_norm(entries);
    return entrywise(
        entries, [&](Eigen::Index i) { return Scalar(1) / std::sqrt(entries.coeff(i) * entries.coeff(i) + least); });
  }

 private:
  /// ρ: with the radius 0.1 of lower levels (kLevelRadius), a posture loses a direction at σ = 0.03 ‖J‖_F. Of 120
  /// positions below the axis of a Panda's tip that leave the workspace and come back, 112 are reached again, and 97
  /// with ρ = 0.1; without scaled rows and with the radius 0.1 ‖J‖_F, 111.
  static constexpr Scalar kPosture = Scalar(0.3);
};

/// The same for a posture of all joints.
template <int N, typename Scalar>
struct ScaledDiagonal {
  DiagonalLevel<N, Scalar> J;
  Vector<N, Scalar> r;

  ScaledDiagonal(const DiagonalLevel<N, Scalar>& rows, const Vector<N, Scalar>& right) noexcept {
    const Vector<N, Scalar> shares = ScaledLevel<N, N, Scalar>::shares_of(rows.entries);
    J = {product(rows, shares)};
    r = entrywise(right, [&](Eigen::Index i) { return right.coeff(i) * shares.coeff(i); });
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
