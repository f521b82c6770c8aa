#pragma once

#include "fpbm/resolver/balance.hpp"
#include "fpbm/resolver/feedback.hpp"
#include "fpbm/resolver/weights.hpp"

namespace fpbm {

/// Weighted minimum velocity norm at acceleration level, (9), which is (7) differentiated (Theorem 1):
///   qdd = J_W⁺(xdd − Jd qd) + N_W W⁻¹Jdᵀ(JW⁻¹Jᵀ)⁻¹xd.
template <int N, typename Scalar = double, typename Weights = DiagonalWeights<N, Scalar>>
struct WMVNAcceleration {
  static constexpr Level kLevel = Level::kAcceleration;

  Weights weights;
  NullSpace<N, Scalar> null_space;   ///< Secondary acceleration z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  explicit WMVNAcceleration(const Weights& weights_, const NullSpace<N, Scalar>& null_space_ = {},
                            const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : weights(weights_), null_space(null_space_), singular(singular_) {}

  /// Throws std::invalid_argument where a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    weights.require_dof(dof);
    null_space.require_dof(dof);
  }

  /// Joint accelerations qdd [rad/s²] that give the tip its reference acceleration.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qdd) const noexcept {
    const auto b = commanded_acceleration(Scalar(0), Scalar(0), kinematics, reference, state);
    return balance(Scalar(1), weights, b, null_space, singular, kinematics, reference, state, qdd);
  }
};

}  // namespace fpbm
