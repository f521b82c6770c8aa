#pragma once

#include "fpbm/resolver/feedback.hpp"
#include "fpbm/resolver/least_norm.hpp"
#include "fpbm/resolver/weights.hpp"

namespace fpbm {

/// Minimum velocity norm, (6): qd = J⁺xd. With a secondary velocity z it is the general solution (3),
/// qd = J⁺xd + (I − J⁺J) z.
template <int N, typename Scalar = double>
struct MVN {
  static constexpr Level kLevel = Level::kVelocity;

  Scalar k;                          ///< Position feedback gain [1/s]: xd + k (x ⊖ f(q)) in place of xd.
  NullSpace<N, Scalar> null_space;   ///< Secondary velocity z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  explicit MVN(Scalar k_ = Scalar(0), const NullSpace<N, Scalar>& null_space_ = {},
               const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : k(k_), null_space(null_space_), singular(singular_) {
    validation::require_non_negative("k", k);
  }

  /// Throws std::invalid_argument where a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const { null_space.require_dof(dof); }

  /// Joint velocities qd [rad/s] that give the tip its reference velocity.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qd) const noexcept {
    const auto v = commanded_velocity(k, kinematics, reference);
    return least_norm<kLevel>(UnitWeights{}, v, null_space, singular, kinematics.J, state, qd);
  }
};

}  // namespace fpbm
