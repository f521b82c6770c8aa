#pragma once

#include "fpbm/limits/detail/box.hpp"
#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/detail/saturation.hpp"
#include "fpbm/linalg/detail/level_space.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/singular/detail/damped_level.hpp"

namespace fpbm {

/// Resolves task levels J_k u = b_k in strict priority, within a box and further rows g·u ≤ b (docs/priority.md, Task
/// levels in your own loop). u₀ = rest, and for each level
///
///   d = u_{k−1} + Z_{k−1} (J_k Z_{k−1})⁺ (b_k − J_k u_{k−1})
///   u_k = u_{k−1} + s_k (d − u_{k−1}) + Z_k γ  within the bounds,   s_k ∈ [0, 1] as large as possible,
///
/// where Z_k is a basis of the null space of J₁ … J_k (LevelSpace). With the null-space motion Z_k γ, other joints
/// compensate for joints on their bounds (NullSpaceSaturation). u_k keeps every bound that rest keeps. J_i u of a
/// higher level i changes by round-off error only. s_k is the optimum of the linear program in s_k and γ. If the higher
/// levels contradict a task, d is the least-squares solution, and s_k scales the step from u_{k−1} to d.
/// docs/priority.md has the proofs.
template <int N, typename Scalar = double, int P = 0>
class LevelSaturation {
 public:
  using JointVector = Vector<N, Scalar>;

  /// box: bounds [rad/s²], or [rad/s] at velocity level. rest: motion within the box from which the first level starts.
  /// unit: unit of each joint's motion for norms, as in NullSpaceSaturation.
  LevelSaturation(const Box<N, Scalar>& box, const JointVector& rest, const JointVector& unit,
                  const Rows<N, P, Scalar>& rows = {}) noexcept
      : box_(box), rows_(rows), unit_(unit), u_(rest), space_(rest.size()) {}

  /// Resolves the next level and returns its scale s_k. J is M × n, b has M entries. If J or b is not finite, the level
  /// is skipped, with scale 0.
  template <int M>
  Scalar resolve(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& b) noexcept {
    return next(J, b, [&](const auto& scaled, const auto& r) noexcept { return space_.add(scaled, r); });
  }

  /// Resolves the next level with damping (DampedLevel): d = u_{k−1} + Z Aᵀ(A Aᵀ + Δ)⁻¹ r with A = J_k Z, Z = Z_{k−1}
  /// and r = b_k − J_k u_{k−1}, in the units of the joints. radius in [0, 1]: ε = radius ‖J_k‖_F. If no singular value
  /// of A is below ε, the result is the result of resolve(J, b).
  template <int M>
  Scalar resolve(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& b, Scalar radius) noexcept {
    return next(J, b, [&](const Matrix<M, N, Scalar>& scaled, const Vector<M, Scalar>& r) noexcept {
      DampedLevel<M, Scalar> damped(radius * radius * squared_norm(scaled));
      const JointVector y = space_.add(scaled, r, damped);
      lost_ = damped.lost();
      return y;
    });
  }

  /// tr Δ/ε² of the last level: about the number of lost directions of the level, plus the number of its dependent
  /// rows. Without damping, 0.
  [[nodiscard]] Scalar lost() const noexcept { return lost_; }

  /// u_k of the last level.
  [[nodiscard]] const JointVector& motion() const noexcept { return u_; }
  /// Null space of all levels so far.
  [[nodiscard]] const LevelSpace<N, Scalar>& space() const noexcept { return space_; }

 private:
  /// Implements resolve(). solution(J in the units of the joints, r) returns the solution of the level, and adds the
  /// level to the space.
  template <int M, typename Solution>
  Scalar next(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& b, const Solution& solution) noexcept {
    lost_ = Scalar(0);
    if (!J.allFinite() || !b.allFinite()) return Scalar(0);
    if (space_.rank() == space_.size()) return Scalar(1);  // The higher levels determine the motion.
    const Vector<M, Scalar> residual = b - J.lazyProduct(u_);
    const JointVector desired = u_ + unit_.cwiseProduct(solution(in_units(J, unit_), residual));
    if (!desired.allFinite()) return Scalar(0);
    if (box_.contains(desired) && rows_.admit(desired)) {
      u_ = desired;
      return Scalar(1);
    }
    NullSpaceSaturation<Eigen::Dynamic, N, Scalar, P> saturation(space_, unit_, rows_);
    const SaturatedMotion<N, Scalar> found = saturation(box_, u_, desired);
    if (!found.u.allFinite()) return Scalar(0);
    u_ = found.u;
    return found.scale;
  }

  Box<N, Scalar> box_;
  Rows<N, P, Scalar> rows_;
  JointVector unit_;
  JointVector u_;
  LevelSpace<N, Scalar> space_;
  Scalar lost_{0};
};

}  // namespace fpbm
