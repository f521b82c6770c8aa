#pragma once

#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/singular/lost_directions.hpp"

namespace fpbm {

/// Solves a task level that is nearly singular, or nearly contradicts higher levels: with L of LevelSpace::add(),
///
///   w = Lᵀ (L Lᵀ + Δ)⁻¹ r
///
/// and the Δ of LostDirections for ε = radius ‖A‖_F, which acts in the directions alone that the higher levels and the
/// posture leave less than ε of. Without such a direction, w = L⁻¹r to round-off. |w| ≤ 1.17 |r| / ε, and w is a
/// continuous function of L and r.
template <int M, typename Scalar>
class DampedLevel {
 public:
  /// epsilon_squared: ε².
  explicit DampedLevel(Scalar epsilon_squared) noexcept : epsilon_squared_(epsilon_squared) {}

  [[nodiscard]] Vector<M, Scalar> operator()(const Matrix<M, M, Scalar>& L, const Vector<M, Scalar>& r) noexcept {
    const Matrix<M, M, Scalar> gram = gram_of(L);
    const LostDirections<M, Scalar> directions(gram, epsilon_squared_);
    lost_ = directions.count;
    Cholesky<M, Scalar> cholesky;
    if (cholesky.factor(sum_of<M, M, Scalar>(gram, directions.delta)) != Status::kOk) {
      return filled<Vector<M, Scalar>>(M);
    }
    return transpose_times(L, cholesky.solve(r));
  }

  /// tr Δ/ε²: about the number of directions that are lost.
  [[nodiscard]] Scalar lost() const noexcept { return lost_; }

 private:
  Scalar epsilon_squared_;
  Scalar lost_{0};
};

}  // namespace fpbm
