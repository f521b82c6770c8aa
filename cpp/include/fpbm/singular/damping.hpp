#pragma once

#include "fpbm/core/validation.hpp"

namespace fpbm {

/// Damping near singular postures: keeps every scheme bounded at and through them.
///
/// In place of JW⁻¹Jᵀ the schemes invert JW⁻¹Jᵀ + Δ (damped least squares: Nakamura and Hanafusa 1986, Wampler 1986),
/// with the Δ of LostDirections, which acts only in the directions that the tip is about to lose, and ε = radius ‖J‖_F.
/// Rows of J that are angular count by the arm's characteristic length, so that all are in metres.
/// Δ is smooth in q, and exactly zero while σ_min ≥ ε. ‖Jᵀ(JJᵀ + Δ)⁻¹‖ ≤ 1.17/ε, and with weights, whose W⁻¹ has a
/// largest diagonal entry of 1, ‖W⁻¹Jᵀ(JW⁻¹Jᵀ + Δ)⁻¹‖ ≤ 1.28 √cond(W)/ε.
///
/// A lost direction joins the null space. At acceleration level z gains −brake (tr Δ/ε²) qd, so that an arm drawn to a
/// target out of reach comes to rest at the edge.
template <typename Scalar = double>
class SingularDamping {
 public:
  /// radius: share of ‖J‖_F, in [0, 1], below which a singular value counts as being lost; 0 switches damping off.
  /// brake: damping of the null space at a singular posture [1/s]. Throws std::invalid_argument on a bad value.
  explicit SingularDamping(Scalar radius = Scalar(0.02), Scalar brake = Scalar(10)) : radius_(radius), brake_(brake) {
    validation::require_fraction("singular_radius", radius);
    validation::require_non_negative("singular_brake", brake);
  }

  /// No damping: the scheme's own law, which fails at a singular posture. The default of every scheme.
  [[nodiscard]] static SingularDamping off() noexcept { return SingularDamping(Scalar(0), Scalar(0)); }

  [[nodiscard]] Scalar radius() const noexcept { return radius_; }
  [[nodiscard]] Scalar brake() const noexcept { return brake_; }

 private:
  Scalar radius_;
  Scalar brake_;
};

}  // namespace fpbm
