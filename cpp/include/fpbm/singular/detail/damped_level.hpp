#pragma once

#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/lower_gram.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/singular/detail/lost_directions.hpp"

namespace fpbm {

/// Radius ε of the damping of lower levels, whose rows are scaled (ScaledLevel). With 0.01 to 0.1,
/// `examples/16_carry_a_tray.cpp` prints an error of 1e-10 m of the tray on its circle; with 0.15, 2e-5 m, and with
/// 0.2, 4e-4 m. In LowerLevels.reach_their_targets_again with all trials, 115 of 120 positions are reached again; 103
/// with 0.05, and 112 with 0.2.
template <typename Scalar>
inline constexpr Scalar kLevelRadius = Scalar(0.1);

/// Solves a task level that is nearly singular, or nearly in conflict with higher levels. With A Z = L Qᵀ
/// (LevelSpace::add),
///
///   w = Lᵀ (L Lᵀ + Δ)⁻¹ r,
///
/// where Δ is the spectral function of LostDirections for ε. Δ is zero in directions in which A Z has a singular value
/// σ ≥ ε. |w| ≤ 1.17 |r|/ε. w is continuous in L and r.
///
/// If rows are dependent, L has fewer columns than rows, and w = (LᵀL + Δ)⁻¹ Lᵀ r. Both forms of w are equal, since
/// L Lᵀ and LᵀL have the same non-zero eigenvalues.
template <int M, typename Scalar>
class DampedLevel {
 public:
  /// epsilon_squared: ε², in the unit of A squared.
  explicit DampedLevel(Scalar epsilon_squared) noexcept : epsilon_squared_(epsilon_squared) {}

  /// Replaces r by w and returns true. If no direction is lost except by dependent rows, returns false, and r does not
  /// change. columns: rank of A Z; the further columns of L are zero.
  [[nodiscard]] bool operator()(const Matrix<M, M, Scalar>& L, Vector<M, Scalar>& r, Eigen::Index columns) noexcept {
    const Eigen::Index m = L.rows();
    const bool dependent = columns < m;
    lost_ = static_cast<Scalar>(m - columns);
    // σ_min ≥ 1/‖L⁻¹‖_F shows for most levels that no direction is lost.
    if (!dependent && epsilon_squared_ * squared_norm_of_inverse(L) <= Scalar(1)) return false;
    const Matrix<M, M, Scalar> gram = dependent ? gram_of_columns(L, columns) : lower_gram(L);
    Cholesky<M, Scalar> cholesky;
    const LostDirections<M, Scalar> directions(gram, dependent ? transpose_of(L) : L, epsilon_squared_);
    if (!(directions.count > Scalar(0))) return false;
    if (cholesky.factor(sum_of(gram, directions.delta)) != Status::kOk) return false;
    lost_ += directions.count;
    fade_ = directions.fade;
    damps_ = true;
    r = dependent ? cholesky.solve(transpose_times(L, r)) : transpose_times(L, cholesky.solve(r));
    return true;
  }

  /// Whether a direction with the singular value sigma is lost.
  [[nodiscard]] bool loses(Scalar sigma) const noexcept { return epsilon_squared_ > sigma * sigma; }

  /// tr Δ/ε², about the number of lost directions, plus the number of dependent rows.
  [[nodiscard]] Scalar lost() const noexcept { return lost_; }

  /// Whether a direction is damped, apart from dependent rows.
  [[nodiscard]] bool damps() const noexcept { return damps_; }

  /// LostDirections::fade of the damped directions.
  [[nodiscard]] Scalar fade() const noexcept { return fade_; }

 private:
  /// ‖L⁻¹‖²_F.
  [[nodiscard]] static Scalar squared_norm_of_inverse(const Matrix<M, M, Scalar>& L) noexcept {
    const auto m = extent<M>(L.rows());
    Scalar inverse[kCapacity<M>][kCapacity<M>];
    Scalar sum(0);
    each(Constant<0>{}, m, [&](auto i) {
      const Scalar reciprocal = Scalar(1) / L.coeff(i, i);
      each(Constant<0>{}, i, [&](auto j) {
        Scalar entry(0);
        each(j, i, [&](Eigen::Index k) { entry -= L.coeff(i, k) * inverse[k][j]; });
        inverse[i][j] = entry * reciprocal;
        sum += inverse[i][j] * inverse[i][j];
      });
      inverse[i][i] = reciprocal;
      sum += reciprocal * reciprocal;
    });
    return sum;
  }

  /// LᵀL. Each zero column of L has a large eigenvalue instead of 0, so that the column does not count as lost.
  [[nodiscard]] Matrix<M, M, Scalar> gram_of_columns(const Matrix<M, M, Scalar>& L,
                                                     Eigen::Index columns) const noexcept {
    auto gram = filled<Matrix<M, M, Scalar>>(L.rows());
    Scalar trace = epsilon_squared_;
    for (Eigen::Index i = 0; i < columns; ++i) {
      for (Eigen::Index j = 0; j < columns; ++j) {
        gram.coeffRef(i, j) = sum_over(column(L, i), [&](Eigen::Index k) { return L.coeff(k, i) * L.coeff(k, j); });
      }
      trace += gram.coeff(i, i);
    }
    for (Eigen::Index i = columns; i < L.rows(); ++i) gram.coeffRef(i, i) = kApart * trace;
    return gram;
  }

  /// Eigenvalue of each zero column of L, relative to tr(LᵀL) + ε². More than 1, so that the eigenvalue is above ε².
  /// The pivot tolerance of the Cholesky factorisation, 64 ε in float, is relative to this eigenvalue: with 1e3, the
  /// factorisation rejects the other eigenvalues (DampedLevels.in_float_damp_dependent_rows).
  static constexpr Scalar kApart = Scalar(2);

  Scalar epsilon_squared_;
  Scalar lost_{0};
  Scalar fade_{1};
  bool damps_ = false;
};

}  // namespace fpbm
