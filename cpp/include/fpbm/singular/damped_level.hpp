#pragma once

#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/singular/lost_directions.hpp"

namespace fpbm {

/// Solves a task level that is nearly singular, or nearly contradicts higher levels. With A = L Qᵀ (LevelSpace::add),
///
///   w = Lᵀ (L Lᵀ + Δ)⁻¹ r,
///
/// where Δ is the spectral function of LostDirections for ε. Δ is zero for the directions of which the posture and the
/// higher levels leave a singular value σ ≥ ε of A. |w| ≤ 1.17 |r|/ε. w is continuous in L and r.
template <int M, typename Scalar>
class DampedLevel {
 public:
  /// epsilon_squared: ε², in the squared unit of A.
  explicit DampedLevel(Scalar epsilon_squared) noexcept : epsilon_squared_(epsilon_squared) {}

  /// Replaces r by w and returns true. If no direction is lost, leaves r as given and returns false.
  [[nodiscard]] bool operator()(const Matrix<M, M, Scalar>& L, Vector<M, Scalar>& r) noexcept {
    const Matrix<M, M, Scalar> gram = gram_of(L);
    Cholesky<M, Scalar> cholesky;
    // σ_min² ≥ 1/tr((L Lᵀ)⁻¹) settles most levels without a decomposition into eigenvectors.
    const bool regular = cholesky.factor(gram) == Status::kOk;
    if (regular && epsilon_squared_ * cholesky.inverse_trace() <= Scalar(1)) return false;
    const LostDirections<M, Scalar> directions(gram, epsilon_squared_);
    if (!(directions.count > Scalar(0))) return false;
    if (cholesky.factor(sum_of(gram, directions.delta)) != Status::kOk) return false;
    lost_ = directions.count;
    r = transpose_times(L, cholesky.solve(r));
    return true;
  }

  /// tr Δ/ε²: about the number of lost directions. 0 if the level is not damped.
  [[nodiscard]] Scalar lost() const noexcept { return lost_; }

 private:
  Scalar epsilon_squared_;
  Scalar lost_{0};
};

}  // namespace fpbm
