#pragma once

#include "fpbm/resolver/balance.hpp"
#include "fpbm/resolver/feedback.hpp"
#include "fpbm/resolver/weights.hpp"

namespace fpbm {

/// Balance of MAN (8) and WMVN (9) without feedback, (16): qdd = (1−α) MAN + α WMVN.
template <int N, typename Scalar = double, typename Weights = DiagonalWeights<N, Scalar>>
struct Balanced {
  static constexpr Level kLevel = Level::kAcceleration;

  Scalar alpha;  ///< Share of WMVN, in [0, 1].
  Weights weights;
  NullSpace<N, Scalar> null_space;   ///< Secondary acceleration z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  Balanced(Scalar alpha_, const Weights& weights_, const NullSpace<N, Scalar>& null_space_ = {},
           const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : alpha(alpha_), weights(weights_), null_space(null_space_), singular(singular_) {
    validation::require_fraction("alpha", alpha);
  }

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
    return balance(alpha, weights, b, null_space, singular, kinematics, reference, state, qdd);
  }
};

}  // namespace fpbm
