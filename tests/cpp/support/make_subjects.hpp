#pragma once

#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/schemes.hpp"
#include "support/subjects.hpp"

namespace fpbm::test {

/// A planar arm with these links.
template <typename Arm, typename Scalar = typename Arm::Scalar>
[[nodiscard]] std::enable_if_t<std::is_constructible_v<Arm, Vector<Arm::kDof, Scalar>>, Arm> arm_of(
    const Eigen::VectorXd& lengths) {
  return Arm(lengths.cast<Scalar>());
}

/// An arm in space with these links, upright at q = 0, whose joints rotate alternately about z and x. Arms with eight
/// joints or more are on a rail along x.
template <typename Arm, typename Scalar = typename Arm::Scalar>
[[nodiscard]] std::enable_if_t<std::is_constructible_v<Arm, Chain<Scalar>>, Arm> arm_of(
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

/// The Panda, for all links.
[[nodiscard]] inline SerialArm<7> panda_arm(const Eigen::VectorXd&) {
  return SerialArm<7>(presets::panda());
}

/// x ⊖ f(q): the difference of positions as rounded by the Scalar, and the desired rotation.
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

/// A scene in the types of the library, and in the types of the textbook.
template <typename Space, int N, typename Scalar>
struct Staged {
  State<N, Scalar> state;
  Kinematics<Space, N, Scalar> kinematics;
  Reference<Space, Scalar> reference;
  Situation at;
};

template <typename Space, typename Arm>
[[nodiscard]] Staged<Space, Arm::kDof, typename Arm::Scalar> stage(const Arm& arm, const Scene& scene) {
  using Scalar = typename Arm::Scalar;
  Staged<Space, Arm::kDof, Scalar> result;
  auto& [state, kinematics, reference, at] = result;
  state = {scene.q.cast<Scalar>(), scene.qd.cast<Scalar>()};
  arm.kinematics(state.q, state.qd, kinematics);
  const Vector<Space::kRows, Scalar> displacement = scene.displacement.cast<Scalar>();
  reference = {Space::template displace<Scalar>(kinematics.tip, displacement), scene.xd.cast<Scalar>(),
               scene.xdd.cast<Scalar>()};
  at = {real(state.q),
        real(state.qd),
        RealVector(),
        real(kinematics.J),
        real(kinematics.Jd),
        error_of<Space, Scalar>(reference.x, kinematics.tip, real(scene.displacement)),
        real(reference.xd),
        real(reference.xdd),
        RealVector::Ones(Space::kRows)};
  at.units.tail(Space::kTurns).setConstant(static_cast<Real>(kinematics.length));
  return result;
}

/// Resolves scenes by all schemes of one type, under any name of the paper. Compiled once for all these schemes.
template <typename Arm, typename Space, typename Scheme>
[[nodiscard]] std::function<Outcome(const Law&, const Scene&)> resolver(Arm (*make_arm)(const Eigen::VectorXd&),
                                                                        std::function<Scheme(const Law&)> make_scheme) {
  using Scalar = typename Arm::Scalar;
  return [make_arm, make_scheme = std::move(make_scheme)](const Law& law, const Scene& scene) {
    const auto staged = stage<Space>(make_arm(scene.lengths), scene);
    Vector<Arm::kDof, Scalar> u =
        Vector<Arm::kDof, Scalar>::Constant(scene.q.size(), static_cast<Scalar>(Outcome::kSentinel));
    const Status status = make_scheme(law).resolve(staged.kinematics, staged.reference, staged.state, u);
    return Outcome{status, real(u), staged.at};
  };
}

/// Every scheme on one type of arm with `dof` joints, with one type of task.
template <typename Arm, typename Space, Kinds kKinds = Kinds::kAll>
[[nodiscard]] std::vector<Subject> make_subjects(const std::string& name, int dof,
                                                 Arm (*make_arm)(const Eigen::VectorXd&) = &arm_of<Arm>) {
  constexpr int N = Arm::kDof;
  using Scalar = typename Arm::Scalar;
  std::vector<Subject> all;
  for_every_scheme<N, Scalar, kKinds>([&](const std::string& scheme, const Takes& takes, const auto& make_scheme) {
    using Scheme = decltype(make_scheme(std::declval<const Law&>()));
    const auto epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    all.push_back(
        {scheme + "_" + name, dof, Space::kRows, epsilon, takes, resolver<Arm, Space, Scheme>(make_arm, make_scheme)});
  });
  return all;
}

}  // namespace fpbm::test
