#pragma once

#include "fpbm/resolver/feedback.hpp"
#include "fpbm/resolver/least_norm.hpp"
#include "fpbm/resolver/weights.hpp"

namespace fpbm {

/// Minimum acceleration norm, (8): qdd = J⁺(xdd − Jd qd). With a secondary acceleration z it is the general solution
/// (5), qdd = J⁺(xdd − Jd qd) + (I − J⁺J) z.
///
/// Nothing in it damps the self-motion or corrects the tip: any error grows.
template <int N, typename Scalar = double>
struct MAN {
  static constexpr Level kLevel = Level::kAcceleration;

  NullSpace<N, Scalar> null_space;   ///< Secondary acceleration z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  explicit MAN(const NullSpace<N, Scalar>& null_space_ = {},
               const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : null_space(null_space_), singular(singular_) {}

  /// Throws std::invalid_argument where a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const { null_space.require_dof(dof); }

  /// Joint accelerations qdd [rad/s²] that give the tip its reference acceleration.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qdd) const noexcept {
    const auto b = commanded_acceleration(Scalar(0), Scalar(0), kinematics, reference, state);
    return least_norm<kLevel>(UnitWeights{}, b, null_space, singular, kinematics.J, state, qdd);
  }
};

}  // namespace fpbm
