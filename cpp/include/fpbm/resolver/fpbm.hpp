#pragma once

#include "fpbm/resolver/balance.hpp"
#include "fpbm/resolver/feedback.hpp"
#include "fpbm/resolver/weights.hpp"

namespace fpbm {

/// Feedback-added pseudoinverse-type balanced minimisation, (13): the balance (16) of MAN and WMVN with
///   b = xdd − Jd qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q))
/// in place of xdd − Jd qd, so that the tip error e obeys ë + k₁ė + k₂e = 0 whatever α and W.
template <int N, typename Scalar = double, typename Weights = DiagonalWeights<N, Scalar>>
struct FPBM {
  static constexpr Level kLevel = Level::kAcceleration;

  Scalar alpha;  ///< Share of WMVN, in [0, 1].
  Weights weights;
  Scalar k1;                         ///< Velocity feedback gain [1/s].
  Scalar k2;                         ///< Position feedback gain [1/s²].
  NullSpace<N, Scalar> null_space;   ///< Secondary acceleration z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  FPBM(Scalar alpha_, const Weights& weights_, Scalar k1_, Scalar k2_, const NullSpace<N, Scalar>& null_space_ = {},
       const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : alpha(alpha_), weights(weights_), k1(k1_), k2(k2_), null_space(null_space_), singular(singular_) {
    validation::require_fraction("alpha", alpha);
    validation::require_non_negative("k1", k1);
    validation::require_non_negative("k2", k2);
  }

  /// Throws std::invalid_argument where a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    weights.require_dof(dof);
    null_space.require_dof(dof);
  }

  /// Joint accelerations qdd [rad/s²] that give the tip its reference acceleration, corrected by the feedback.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qdd) const noexcept {
    const auto b = commanded_acceleration(k1, k2, kinematics, reference, state);
    return balance(alpha, weights, b, null_space, singular, kinematics, reference, state, qdd);
  }
};

}  // namespace fpbm
