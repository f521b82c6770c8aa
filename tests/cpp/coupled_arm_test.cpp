#include "fpbm/model/coupled_arm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// Joints that follow others keep their own bounds.
namespace fpbm::test::coupled_arm_laws {
namespace {

constexpr double kSlack = 1e-9;
constexpr double kNone = JointBounds<>::kNone;
constexpr int kOpen = Eigen::Dynamic;

[[nodiscard]] Joint<> random_joint(Random& random) {
  Joint<> joint;
  joint.type = random.uniform(0.0, 1.0) < 0.2 ? JointType::kPrismatic : JointType::kRevolute;
  joint.placement.R = rotation(Vector<3>(random.uniform(3, -1.5, 1.5)));
  joint.placement.p = random.uniform(3, -0.4, 0.4);
  joint.axis = random.uniform(3, -1.0, 1.0);
  const double middle = random.uniform(-1.0, 1.0);
  const double reach = random.uniform(0.3, 2.0);
  joint.bounds = {middle - reach, middle + reach, random.uniform(0.3, 3.0), random.uniform(2.0, 20.0)};
  return joint;
}

/// From a random joint on, every third joint follows another joint (its leader), which is before or after the follower
/// in the chain. The middle of the range of the leader moves the follower to the middle of its range.
[[nodiscard]] Chain<> random_coupled_chain(Random& random) {
  Chain<> chain;
  for (int i = 0; i < 9; ++i) chain.joints.push_back(random_joint(random));
  const auto below = [&](double end) { return static_cast<std::size_t>(random.uniform(0.0, end - 1e-3)); };
  const std::size_t first = below(3.0);
  for (std::size_t i = first; i < chain.joints.size(); i += 3) {
    std::size_t leader = below(9.0);
    while (leader % 3 == first) leader = below(9.0);
    Joint<>& joint = chain.joints[i];
    const double size = std::pow(10.0, random.uniform(-1.0, 0.5));
    const double kind = random.uniform(0.0, 1.0);
    joint.mimic = {static_cast<int>(leader), kind < 0.1 ? 0.0 : kind < 0.5 ? -size : size, random.uniform(-1.0, 1.0)};
    const JointBounds<>& led = chain.joints[leader].bounds;
    const double middle = joint.mimic.ratio * (led.lower + led.upper) / 2.0 + joint.mimic.offset;
    const double reach = random.uniform(0.1, 1.5);
    joint.bounds.lower = random.uniform(0.0, 1.0) < 0.2 ? -kNone : middle - reach;
    joint.bounds.upper = random.uniform(0.0, 1.0) < 0.2 ? kNone : middle + reach;
    if (random.uniform(0.0, 1.0) < 0.2) joint.bounds.acceleration = kNone;
  }
  return chain;
}

/// Largest excess of a follower over its own bounds.
template <typename Result>
[[nodiscard]] double violation(const Chain<>& chain, const Result& tick) {
  std::vector<Eigen::Index> drive(chain.joints.size());
  Eigen::Index drives = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) drive[i] = chain.joints[i].mimic.joint < 0 ? drives++ : -1;
  double worst = -kNone;
  for (const Joint<>& joint : chain.joints) {
    if (joint.mimic.joint < 0) continue;
    const Eigen::Index leader = drive[static_cast<std::size_t>(joint.mimic.joint)];
    const double q = joint.mimic.ratio * tick.q(leader) + joint.mimic.offset;
    worst = std::max({worst, q - joint.bounds.upper, joint.bounds.lower - q,
                      std::abs(joint.mimic.ratio * tick.qd(leader)) - joint.bounds.velocity,
                      std::abs(joint.mimic.ratio * tick.qdd(leader)) - joint.bounds.acceleration});
  }
  return worst;
}

/// Starts in the middle of the joint ranges, with references that jump and that no joint can follow.
template <typename Scheme>
void expect_followers_within_bounds(const Chain<>& chain, const Scheme& scheme, Random& random, double& worst) {
  using Space = Position<3>;
  const AnyArm<Space> arm = any_arm(chain);
  CompiledTracker tracker(arm, Space{}, scheme, Vector<kOpen>((arm.limits().lower + arm.limits().upper) / 2.0));
  auto reference = Reference<Space>::hold(tracker.tip());
  for (int i = 0; i < 200; ++i) {
    if (i % 20 == 0) {
      const double size = std::pow(10.0, random.uniform(-2.0, 1.5));
      reference = {tracker.tip() + Vector<3>(random.uniform(3, -size, size)), random.uniform(3, -size, size),
                   random.uniform(3, -size, size)};
    }
    const auto tick = tracker.tick(reference);
    ASSERT_FALSE(failed(tick.status)) << message(tick.status);
    const double broken = violation(chain, tick);
    ASSERT_LE(broken, kSlack) << "tick " << i;
    worst = std::max(worst, broken);
  }
}
TEST(CoupledArm, keeps_the_bounds_of_mimic_joints) {
  double worst = -kNone;
  const int chains = trials(300);
  for (int seed = 0; seed < chains; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint32_t>(seed));
    const Chain<> chain = random_coupled_chain(random);
    const Vector<kOpen> weights = random.uniform(6, 0.5, 5.0);
    const auto z = NullSpace<kOpen>{}.with_damping(2.0);
    expect_followers_within_bounds(chain, FPBM<kOpen>(0.6, weights, 20.0, 100.0, z), random, worst);
    expect_followers_within_bounds(chain, WMVN<kOpen>(weights, 10.0), random, worst);
  }
  std::printf("%d coupled chains, worst violation %.1e\n", chains, worst);
}

/// A leader with one follower before it and one after it.
template <typename Scalar>
[[nodiscard]] Chain<Scalar> three_joints(const Mimic<Scalar>& mimic, const JointBounds<Scalar>& bounds) {
  Chain<Scalar> chain;
  chain.joints.resize(3);
  chain.joints[1].bounds = {Scalar(-1), Scalar(2), Scalar(3), Scalar(4)};
  chain.joints[0].bounds = bounds;
  chain.joints[0].mimic = mimic;
  chain.joints[2].mimic = {1, Scalar(0.5), Scalar(0)};
  return chain;
}

template <typename Scalar>
void expect_leader_within_both() {
  constexpr Scalar kFree = JointBounds<Scalar>::kNone;
  const auto expect = [](const Mimic<Scalar>& mimic, const JointBounds<Scalar>& bounds,
                         const JointBounds<Scalar>& expected) {
    const auto limits = CoupledArm<1, Scalar>(three_joints(mimic, bounds)).limits();
    EXPECT_EQ(limits.lower(0), expected.lower);
    EXPECT_EQ(limits.upper(0), expected.upper);
    EXPECT_EQ(limits.velocity(0), expected.velocity);
    EXPECT_EQ(limits.acceleration(0), expected.acceleration);
  };
  const JointBounds<Scalar> bounds{Scalar(-1), Scalar(2), Scalar(3), Scalar(4)};
  expect({1, Scalar(1), Scalar(0)}, bounds, bounds);
  expect({1, Scalar(2), Scalar(0)}, bounds, {Scalar(-0.5), Scalar(1), Scalar(1.5), Scalar(2)});
  expect({1, Scalar(-2), Scalar(0)}, bounds, {Scalar(-1), Scalar(0.5), Scalar(1.5), Scalar(2)});
  expect({1, Scalar(0.125), Scalar(1)}, bounds, bounds);
  expect({1, Scalar(-1), Scalar(1.5)}, bounds, {Scalar(-0.5), Scalar(2), Scalar(3), Scalar(4)});
  expect({1, Scalar(0), Scalar(2)}, bounds, bounds);
  expect({1, Scalar(-4), Scalar(1)}, {}, bounds);
  expect({1, Scalar(-2), Scalar(0)}, {-kFree, Scalar(1), Scalar(1), kFree}, {Scalar(-0.5), Scalar(2), Scalar(0.5), 4});
}
TEST(CoupledArm, bounds_a_leader_by_its_followers) {
  expect_leader_within_both<double>();
  expect_leader_within_both<float>();
}

TEST(CoupledArm, names_the_joint_without_range) {
  const auto refusal = [](const Mimic<>& mimic, const char* name = "") {
    Chain<> chain = three_joints<double>(mimic, {-1.0, 2.0, 3.0, 4.0});
    chain.joints[0].name = chain.joints[1].name = name;
    return complaint([&] { CoupledArm<1>{chain}; });
  };
  EXPECT_EQ(refusal({1, 1.0, 2.0}), "");
  EXPECT_EQ(refusal({1, 1.0, 3.0}),
            "joints[1].lower = -1: must be below upper = -1 for its mimic joints to keep their bounds");
  EXPECT_EQ(refusal({1, -1.0, -3.0}, "a"),
            "joint 'a'.lower = -1: must be below upper = -2 for its mimic joints to keep their bounds");
  EXPECT_EQ(refusal({1, 0.0, 2.0}), "");
  EXPECT_EQ(refusal({1, 0.0, -1.0}), "");
  EXPECT_EQ(refusal({1, 0.0, 2.5}), "joints[0].mimic.offset = 2.5: must be within the bounds, since the ratio is 0");
  EXPECT_EQ(refusal({1, 0.0, -1.5}, "a"),
            "joint 'a'.mimic.offset = -1.5: must be within the bounds, since the ratio is 0");
}

}  // namespace
}  // namespace fpbm::test::coupled_arm_laws
