#pragma once

#include "fpbm/resolver/feedback.hpp"
#include "fpbm/resolver/least_norm.hpp"
#include "fpbm/resolver/weights.hpp"

namespace fpbm {

/// Weighted minimum velocity norm, (7): qd = J_W⁺xd, the qd of least qdᵀW qd.
template <int N, typename Scalar = double, typename Weights = DiagonalWeights<N, Scalar>>
struct WMVN {
  static constexpr Level kLevel = Level::kVelocity;

  Weights weights;
  Scalar k;                          ///< Position feedback gain [1/s]: xd + k (x ⊖ f(q)) in place of xd.
  NullSpace<N, Scalar> null_space;   ///< Secondary velocity z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  explicit WMVN(const Weights& weights_, Scalar k_ = Scalar(0), const NullSpace<N, Scalar>& null_space_ = {},
                const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : weights(weights_), k(k_), null_space(null_space_), singular(singular_) {
    validation::require_non_negative("k", k);
  }

  /// Throws std::invalid_argument where a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    weights.require_dof(dof);
    null_space.require_dof(dof);
  }

  /// Joint velocities qd [rad/s] that give the tip its reference velocity.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qd) const noexcept {
    const auto v = commanded_velocity(k, kinematics, reference);
    return least_norm<kLevel>(weights, v, null_space, singular, kinematics.J, state, qd);
  }
};

}  // namespace fpbm
