#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fpbm/fpbm.hpp"
#include "support/random.hpp"

/// One arm of every type, for properties of all arms.
namespace fpbm::test {

/// The Panda without its bounds on jerk.
[[nodiscard]] Chain<> panda_without_jerk();

/// The Panda on a rail along y.
[[nodiscard]] Chain<> panda_on_rail();

/// The Panda on a rail, with its last joint geared to its first revolute joint.
[[nodiscard]] Chain<> coupled_panda();

/// make_arm() and make_planar_arm(), compiled once.
[[nodiscard]] AnyArm<Position<3>> any_arm(const Chain<>& chain);
[[nodiscard]] AnyArm<Position<2>> any_planar_arm(const Vector<Eigen::Dynamic>& lengths);

/// A user-defined arm, with kinematics only.
struct OwnArm {
  using Scalar = double;
  static constexpr int kDof = 4;

  [[nodiscard]] static int dof() noexcept { return kDof; }
  template <typename... Arguments>
  void kinematics(Arguments&&... arguments) const noexcept {
    planar.kinematics(std::forward<Arguments>(arguments)...);
  }

  PlanarArm<4> planar = make_planar();

 private:
  [[nodiscard]] static PlanarArm<4> make_planar();
};

template <typename Arm, typename Space_>
struct ArmCase {
  using Space = Space_;
  std::string name;
  Arm arm;
};

/// Calls check(case, q, qd) for each type of arm and task, in random states. AnyArm holds most arms, so that `check` is
/// compiled only for the four pairs of arm and task of AnyArm, and for two of fixed size.
template <typename Check>
void on_every_arm(Check&& check) {
  const auto in_states = [&](const auto& each) {
    using Joints = Vector<std::decay_t<decltype(each.arm)>::kDof>;
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(each.name + ", seed " + std::to_string(seed));
      Random random(seed);
      const Joints q = random.uniform(each.arm.dof(), -1.5, 1.5);
      const Joints qd = random.uniform(each.arm.dof(), -1.0, 1.0);
      check(each, q, qd);
    }
  };
  using Planar = AnyArm<Position<2>>;
  using Spatial = AnyArm<Position<3>>;
  in_states(ArmCase<Planar, Position<2>>{"planar", any_planar_arm(Vector<4>::Ones())});
  const std::vector<std::pair<std::string, Chain<>>> chains = {
      {"panda", presets::panda()}, {"rail", panda_on_rail()}, {"coupled", coupled_panda()}};
  for (const auto& [name, chain] : chains) {
    in_states(ArmCase<Spatial, Pose>{name + " pose", any_arm(chain)});
#ifndef FPBM_FEW_TYPES
    in_states(ArmCase<Spatial, Position<3>>{name, any_arm(chain)});
#endif
  }
#ifndef FPBM_FEW_TYPES
  in_states(ArmCase<Planar, PlanarPose>{"planar pose", any_planar_arm(Vector<6>::Ones())});
  in_states(ArmCase<OwnArm, Position<2>>{"own", OwnArm{}});
  in_states(ArmCase<SerialArm<7>, Pose>{"panda pose, of fixed size", SerialArm<7>(presets::panda())});
#endif
}

/// A random reference near the tip.
template <typename Space, int N>
[[nodiscard]] Reference<Space> random_reference(Random& random, const Kinematics<Space, N>& kinematics) {
  constexpr int M = Space::kRows;
  const Vector<M> error = random.uniform(M, -0.1, 0.1);
  return {Space::template displace<double>(kinematics.tip, error), random.uniform(M, -0.5, 0.5),
          random.uniform(M, -0.5, 0.5)};
}

/// The message of the std::invalid_argument that throw_it() throws. Empty if throw_it() does not throw.
template <typename Throw>
[[nodiscard]] std::string complaint(Throw&& throw_it) {
  try {
    throw_it();
  } catch (const std::invalid_argument& caught) {
    return caught.what();
  }
  return {};
}

}  // namespace fpbm::test
