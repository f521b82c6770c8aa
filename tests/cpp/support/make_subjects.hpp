#pragma once

#include <limits>
#include <string>
#include <vector>

#include "support/schemes.hpp"
#include "support/subjects.hpp"

namespace fpbm::test {

template <typename Arm, typename Scheme>
[[nodiscard]] Outcome resolve_erased(const Law& law, const Scene& scene) {
  using Scalar = typename Arm::Scalar;
  using Joints = Vector<Arm::kDof, Scalar>;
  const Arm arm(scene.lengths.cast<Scalar>());
  const State<Arm::kDof, Scalar> state{scene.q.cast<Scalar>(), scene.qd.cast<Scalar>()};
  Kinematics<Position<2>, Arm::kDof, Scalar> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  const Vector<2, Scalar> x = kinematics.tip + scene.displacement.cast<Scalar>();
  const Reference<Position<2>, Scalar> reference{x, scene.xd.cast<Scalar>(), scene.xdd.cast<Scalar>()};

  Joints u = Joints::Constant(scene.q.size(), static_cast<Scalar>(Outcome::kSentinel));
  const Status status = SchemeTraits<Scheme>::make(law).resolve(kinematics, reference, state, u);
  return {status,
          real(u),
          {real(state.q), real(state.qd), real(kinematics.tip), real(kinematics.J), real(kinematics.Jd), real(x),
           real(reference.xd), real(reference.xdd)}};
}

template <typename Arm, typename Scheme>
[[nodiscard]] Subject make_subject(const std::string& name, int dof) {
  using Traits = SchemeTraits<Scheme>;
  return {name,
          dof,
          static_cast<double>(std::numeric_limits<typename Arm::Scalar>::epsilon()),
          Traits::kKind,
          Scheme::kLevel,
          Traits::kWeighted,
          Traits::kDense,
          &resolve_erased<Arm, Scheme>};
}

/// Every scheme on one kind of arm, of dof joints.
template <typename Arm>
[[nodiscard]] std::vector<Subject> make_subjects(const std::string& arm, int dof) {
  constexpr int N = Arm::kDof;
  using S = typename Arm::Scalar;
  using Dense = DenseWeights<N, S>;
  return {make_subject<Arm, MVN<N, S>>("MVN_" + arm, dof),
          make_subject<Arm, WMVN<N, S>>("WMVN_" + arm, dof),
          make_subject<Arm, WMVN<N, S, Dense>>("WMVN_dense_" + arm, dof),
          make_subject<Arm, MAN<N, S>>("MAN_" + arm, dof),
          make_subject<Arm, WMVNAcceleration<N, S>>("WMVNAcceleration_" + arm, dof),
          make_subject<Arm, WMVNAcceleration<N, S, Dense>>("WMVNAcceleration_dense_" + arm, dof),
          make_subject<Arm, Balanced<N, S>>("Balanced_" + arm, dof),
          make_subject<Arm, Balanced<N, S, Dense>>("Balanced_dense_" + arm, dof),
          make_subject<Arm, FPBM<N, S>>("FPBM_" + arm, dof),
          make_subject<Arm, FPBM<N, S, Dense>>("FPBM_dense_" + arm, dof)};
}

}  // namespace fpbm::test
