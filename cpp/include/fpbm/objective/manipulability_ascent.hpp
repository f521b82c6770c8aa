#pragma once

#include <utility>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/linalg/detail/null_basis.hpp"
#include "fpbm/model/manipulability.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// Scheme with null-space motion that increases the manipulability w = √det(JJᵀ), away from singular postures
/// (Yoshikawa 1985; docs/equations.md, Secondary objectives): u + gain ZZᵀ∇w, where u is the result of the wrapped
/// scheme and Z an orthonormal basis of the null space of J.
///
/// The ascent is also a scheme, and may be wrapped again. At acceleration level, ∇w acts like a force: with
/// NullSpace::with_damping, the arm stops at the best posture; without damping, the arm oscillates about the
/// best posture without decay.
template <typename Scheme, typename Arm>
struct ManipulabilityAscent {
  using Scalar = typename Arm::Scalar;
  static constexpr Level kLevel = Scheme::kLevel;
  static constexpr int kDof = Scheme::kDof;

  Scheme scheme;
  Arm arm;      ///< The arm that the scheme moves, for the derivatives of J.
  Scalar gain;  ///< [rad²/s²], or [rad²/s] at velocity level, per unit of w.

  ManipulabilityAscent(const Scheme& scheme_, const Arm& arm_, Scalar gain_) : scheme(scheme_), arm(arm_), gain(gain_) {
    validation::require_non_negative("manipulability_gain", gain);
  }

  /// Throws std::invalid_argument if a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    scheme.require_dof(dof);
    validation::require_size("joints of ManipulabilityAscent::arm", arm.dof(), dof);
  }

  /// Joint velocities [rad/s] or accelerations [rad/s²]. The motion of the tip is the motion of the wrapped scheme.
  template <typename Space, int N>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& u) const noexcept {
    Vector<N, Scalar> result = Vector<N, Scalar>::Zero(state.q.size());
    const Status status = scheme.resolve(kinematics, reference, state, result);
    if (failed(status)) return status;
    const Vector<N, Scalar> z = gain * manipulability_gradient<Space>(arm, state.q);
    const auto Z = null_basis(kinematics.J);
    result += Z.lazyProduct((Z.transpose().lazyProduct(z)).eval());
    if (!result.allFinite()) return Status::kNotFinite;
    u = std::move(result);
    return status;
  }
};

}  // namespace fpbm
