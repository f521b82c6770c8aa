#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "fpbm/realtime/tracker.hpp"
#include "support/arms.hpp"

/// Toward targets that it cannot reach an arm comes as near as it can, and rests there.
namespace fpbm::test {
namespace {

constexpr int N = Eigen::Dynamic;
constexpr int kSeconds = 40;

/// Of each joint, in place of the arm's own where these are infinite.
[[nodiscard]] JointLimits<N> bounded(JointLimits<N> limits, double acceleration) {
  for (Eigen::Index i = 0; i < limits.lower.size(); ++i) {
    limits.lower(i) = std::max(limits.lower(i), -2.8);
    limits.upper(i) = std::min(limits.upper(i), 2.8);
    limits.velocity(i) = std::min(limits.velocity(i), 2.0);
    limits.acceleration(i) = acceleration;
  }
  return limits;
}

struct Outcome {
  double speed;   ///< Of any joint in the last two seconds [rad/s].
  int reversals;  ///< Of any joint's acceleration, tick by tick.
};

template <typename Space, typename Arm, typename Scheme>
[[nodiscard]] Outcome reach_for(const Arm& arm, const Scheme& scheme, const JointLimits<N>& bounds, Random& random) {
  const Limits<Scheme::kLevel, N> limits(bounds, 1e-3);
  Vector<N> q0 = bounds.lower;
  for (Eigen::Index i = 0; i < q0.size(); ++i) {
    const double share = random.uniform(0.2, 0.8);
    q0(i) += share * (bounds.upper(i) - bounds.lower(i));
  }
  Tracker tracker(arm, Space{}, scheme, State<N>{q0, Vector<N>::Zero(q0.size())}, {}, limits);
  Kinematics<Space, N> kinematics;
  arm.kinematics(q0, kinematics);
  constexpr int kLengths = Space::kRows - Space::kTurns;
  Vector<Space::kRows> away = Vector<Space::kRows>::Zero();
  const Eigen::VectorXd direction = random.uniform(kLengths, -1.0, 1.0).normalized();
  away.template head<kLengths>() = kinematics.length * random.uniform(0.5, 2.0) * direction;
  const auto reference = Reference<Space>::hold(Space::template displace<double>(tracker.tip(), away));
  Outcome outcome{0.0, 0};
  Vector<N> before = Vector<N>::Zero(q0.size());
  for (int i = 0; i < 1000 * kSeconds; ++i) {
    const auto tick = tracker.tick(reference);
    if (i < 1000 * (kSeconds - 2)) continue;
    outcome.speed = std::max(outcome.speed, tick.qd.cwiseAbs().maxCoeff());
    outcome.reversals += (tick.qdd.array() * before.array() < -1.0).any() ? 1 : 0;
    before = tick.qdd;
  }
  return outcome;
}

/// Accelerations from 2 to 40 rad/s².
template <typename Space, typename Arm>
void check(const std::string& name, const Arm& arm, int targets) {
  const Vector<N> ones = Vector<N>::Ones(arm.dof());
  double worst = 0.0;
  for (int k = 0; k < targets; ++k) {
    SCOPED_TRACE(name + ", target " + std::to_string(k));
    Random random(static_cast<std::uint32_t>(k));
    const auto bounds = bounded(arm.limits(), 2.0 * std::pow(20.0, random.uniform(0.0, 1.0)));
    const Vector<N> middle = 0.5 * (bounds.lower + bounds.upper);
    const auto free = NullSpace<N>{}.with_damping(2.0);
    const auto posture = NullSpace<N>{}.with_damping(4.0).with_rest_posture(middle, 4.0);
    const auto resting = NullSpace<N>{}.with_rest_posture(middle, 1.0);
    const double alpha = random.uniform(0.0, 1.0);
    const Vector<N> weights = random.uniform(arm.dof(), 0.5, 5.0);
    const Outcome outcome =
        k % 3 == 0   ? reach_for<Space>(arm, FPBM<N>(alpha, weights, 10.0, 25.0, free), bounds, random)
        : k % 3 == 1 ? reach_for<Space>(arm, FPBM<N>(alpha, weights, 20.0, 100.0, posture), bounds, random)
                     : reach_for<Space>(arm, WMVN<N>(weights, 5.0, resting), bounds, random);
    EXPECT_LE(outcome.speed, 1e-3);
    EXPECT_LE(outcome.reversals, 20);
    worst = std::max(worst, outcome.speed);
  }
  std::printf("%s: %d targets, %d s: at most %.1e rad/s at the end\n", name.c_str(), targets, kSeconds, worst);
}

#ifdef FPBM_NIGHTLY
constexpr int kTargets = 144;
#else
constexpr int kTargets = 3;
#endif

TEST(FarTargets, end_at_rest_in_the_plane) {
  for (int n = 2; n <= 4; ++n)
    check<Position<2>>("planar " + std::to_string(n), any_planar_arm(Vector<N>::Ones(n)), kTargets);
}
TEST(FarTargets, end_at_rest_in_space) {
  check<Pose>("Panda, pose", any_arm(presets::panda()), kTargets);
  check<Position<3>>("Panda, position", any_arm(presets::panda()), kTargets);
  check<Pose>("UR5e, pose", any_arm(presets::ur5e()), kTargets);
  check<Position<3>>("iiwa 14, position", any_arm(presets::iiwa14()), kTargets);
}

}  // namespace
}  // namespace fpbm::test
