#pragma once

#include "fpbm/core/detail/validation.hpp"

namespace fpbm {

/// Damping near singular postures, which bounds the joint motion of every scheme (docs/singularities.md).
///
/// Instead of JW⁻¹Jᵀ, the schemes invert JW⁻¹Jᵀ + Δ (damped least squares: Nakamura and Hanafusa 1986, Wampler 1986). Δ
/// is defined in LostDirections and acts only in nearly lost task directions, with ε = radius ‖J‖_F. Angular rows of J
/// are multiplied by the characteristic length of the arm, so that all rows are in metres.
/// Δ is smooth in q, and exactly zero while σ_min ≥ ε. ‖Jᵀ(JJᵀ + Δ)⁻¹‖ ≤ 1.17/ε. With weights W, scaled so that the
/// largest diagonal entry of W⁻¹ is 1, ‖W⁻¹Jᵀ(JW⁻¹Jᵀ + Δ)⁻¹‖ ≤ 1.28 √cond(W)/ε.
///
/// Secondary motion that depends on the posture is projected on the null space without damping. At acceleration level,
/// −brake (tr Δ/ε²) qd is added to z, so that an arm with an unreachable target stops at the workspace boundary.
template <typename Scalar = double>
class SingularDamping {
 public:
  /// radius: fraction of ‖J‖_F, in [0, 1], below which a singular value counts as lost; 0 switches damping off. brake:
  /// null-space damping at a singular posture [1/s]. docs/singularities.md describes the effect of both values;
  /// docs/figures/singularities.py prints the numbers. Throws std::invalid_argument if a value is out of range.
  explicit SingularDamping(Scalar radius = Scalar(0.02), Scalar brake = Scalar(10)) : radius_(radius), brake_(brake) {
    validation::require_fraction("singular_radius", radius);
    validation::require_non_negative("singular_brake", brake);
  }

  /// No damping, the default of every scheme: the law fails at a singular posture.
  [[nodiscard]] static SingularDamping off() noexcept { return SingularDamping(Scalar(0), Scalar(0)); }

  [[nodiscard]] Scalar radius() const noexcept { return radius_; }
  [[nodiscard]] Scalar brake() const noexcept { return brake_; }

 private:
  Scalar radius_;
  Scalar brake_;
};

}  // namespace fpbm
