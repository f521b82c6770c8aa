#pragma once

#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "support/schemes.hpp"
#include "support/subjects.hpp"

namespace fpbm::test {

/// A planar arm of these links.
template <typename Arm, typename Scalar = typename Arm::Scalar>
[[nodiscard]] std::enable_if_t<std::is_constructible_v<Arm, Vector<Arm::kDof, Scalar>>, Arm> make_arm(
    const Eigen::VectorXd& lengths) {
  return Arm(lengths.cast<Scalar>());
}

/// An arm in space of these links, all upright at q = 0, which turn about x and z by turns; from eight joints on it
/// stands on a rail along x.
template <typename Arm, typename Scalar = typename Arm::Scalar>
[[nodiscard]] std::enable_if_t<std::is_constructible_v<Arm, Chain<Scalar>>, Arm> make_arm(
    const Eigen::VectorXd& lengths) {
  Chain<Scalar> chain;
  for (Eigen::Index i = 0; i < lengths.size(); ++i) {
    Joint<Scalar> joint;
    joint.axis = i % 2 == 0 ? Vector<3, Scalar>::UnitZ() : Vector<3, Scalar>::UnitX();
    if (i > 0) joint.placement.p(2) = static_cast<Scalar>(lengths(i - 1));
    chain.joints.push_back(joint);
  }
  if (lengths.size() >= 8) {
    chain.joints[0].type = JointType::kPrismatic;
    chain.joints[0].axis = Vector<3, Scalar>::UnitX();
  }
  chain.tip.p(2) = static_cast<Scalar>(lengths(lengths.size() - 1));
  return Arm(chain);
}

/// x ⊖ f(q), the difference of positions as the Scalar has it and the turn as it was asked for.
template <typename Space, typename Scalar>
[[nodiscard]] RealVector error_of(const typename Space::template Point<Scalar>& x,
                                  const typename Space::template Point<Scalar>& tip, const RealVector& displacement) {
  RealVector error = displacement;
  if constexpr (std::is_same_v<Space, Pose>) {
    error.head(3) = real(x.p) - real(tip.p);
  } else {
    error = real(x) - real(tip);
  }
  return error;
}

template <typename Arm, typename Space, typename Scheme>
[[nodiscard]] Outcome resolve_erased(const Law& law, const Scene& scene) {
  using Scalar = typename Arm::Scalar;
  using Joints = Vector<Arm::kDof, Scalar>;
  using Rows = Vector<Space::kRows, Scalar>;
  const auto arm = make_arm<Arm>(scene.lengths);
  const State<Arm::kDof, Scalar> state{scene.q.cast<Scalar>(), scene.qd.cast<Scalar>()};
  Kinematics<Space, Arm::kDof, Scalar> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  const auto x = Space::template displace<Scalar>(kinematics.tip, Rows(scene.displacement.cast<Scalar>()));
  const Reference<Space, Scalar> reference{x, scene.xd.cast<Scalar>(), scene.xdd.cast<Scalar>()};

  Joints u = Joints::Constant(scene.q.size(), static_cast<Scalar>(Outcome::kSentinel));
  auto scheme = SchemeTraits<Scheme>::make(law);
  scheme.singular =
      SingularDamping<Scalar>(static_cast<Scalar>(law.singular_radius), static_cast<Scalar>(law.singular_brake));
  const Status status = scheme.resolve(kinematics, reference, state, u);
  return {
      status,
      real(u),
      {real(state.q), real(state.qd), RealVector(), real(kinematics.J), real(kinematics.Jd),
       error_of<Space, Scalar>(x, kinematics.tip, real(scene.displacement)), real(reference.xd), real(reference.xdd)}};
}

template <typename Arm, typename Space, typename Scheme>
[[nodiscard]] Subject make_subject(const std::string& name, int dof) {
  using Traits = SchemeTraits<Scheme>;
  return {name,
          dof,
          Space::kRows,
          static_cast<double>(std::numeric_limits<typename Arm::Scalar>::epsilon()),
          Traits::kKind,
          Scheme::kLevel,
          Traits::kWeighted,
          Traits::kDense,
          &resolve_erased<Arm, Space, Scheme>};
}

/// Every scheme on one kind of arm, of dof joints, with one kind of task.
template <typename Arm, typename Space = Position<2>>
[[nodiscard]] std::vector<Subject> make_subjects(const std::string& arm, int dof) {
  constexpr int N = Arm::kDof;
  using S = typename Arm::Scalar;
  using Dense = DenseWeights<N, S>;
  return {make_subject<Arm, Space, MVN<N, S>>("MVN_" + arm, dof),
          make_subject<Arm, Space, WMVN<N, S>>("WMVN_" + arm, dof),
          make_subject<Arm, Space, WMVN<N, S, Dense>>("WMVN_dense_" + arm, dof),
          make_subject<Arm, Space, MAN<N, S>>("MAN_" + arm, dof),
          make_subject<Arm, Space, WMVNAcceleration<N, S>>("WMVNAcceleration_" + arm, dof),
          make_subject<Arm, Space, WMVNAcceleration<N, S, Dense>>("WMVNAcceleration_dense_" + arm, dof),
          make_subject<Arm, Space, Balanced<N, S>>("Balanced_" + arm, dof),
          make_subject<Arm, Space, Balanced<N, S, Dense>>("Balanced_dense_" + arm, dof),
          make_subject<Arm, Space, FPBM<N, S>>("FPBM_" + arm, dof),
          make_subject<Arm, Space, FPBM<N, S, Dense>>("FPBM_dense_" + arm, dof)};
}

}  // namespace fpbm::test
