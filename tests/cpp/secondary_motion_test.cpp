#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// Secondary motion never moves the tip: an arm at rest is at its target, with a rest posture or joint centring as
/// without, also while directions are damped.
namespace fpbm::test::secondary_motion_laws {
namespace {

constexpr int N = Eigen::Dynamic;
constexpr double kTick = 4e-3;
constexpr double kAtRest = 1e-11;  ///< Largest joint velocity at rest [rad/s].
constexpr double kLargest = 1e-9;  ///< Largest error at rest [m] and [rad].
constexpr double kSeconds = 40.0;

/// Motions of each arm with each task at each level: 200 motions in all. FPBM_MOTIONS=500 for 10,000 motions.
[[nodiscard]] int motions() {
  const char* const given = std::getenv("FPBM_MOTIONS");
  return given != nullptr ? std::atoi(given) : 10;
}

struct Count {
  int motions = 0;
  int at_rest = 0;
  int damped = 0;
  double largest = 0.0;
};

/// A posture in the middle part of the ranges. With `straight`, some joints are nearly straight, so that the arm is
/// nearly singular.
[[nodiscard]] Vector<N> random_posture(const JointLimits<N>& limits, Random& random, bool straight) {
  Vector<N> q = limits.lower;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double lower = std::max(limits.lower(i), -3.0);
    const double upper = std::min(limits.upper(i), 3.0);
    q(i) = 0.5 * (lower + upper) + 0.45 * (upper - lower) * random.uniform(-1.0, 1.0);
    if (straight && random.uniform(0.0, 1.0) < 0.4) {
      q(i) = std::clamp(random.uniform(-0.02, 0.02), lower + 0.05, upper - 0.05);
    }
  }
  return q;
}

/// Moves a tracker toward a reachable target until it rests, and counts the errors.
template <typename Tracker_, typename Target>
void count(Tracker_& tracker, const Target& target, Count& counts) {
  auto tick = tracker.tick(target);
  int still = 0;
  for (double t = 0.0; t < kSeconds && still < 50; t += kTick) {
    tick = tracker.tick(target);
    still = tick.qd.cwiseAbs().maxCoeff() < kAtRest ? still + 1 : 0;
  }
  ++counts.motions;
  if (tick.status > Status::kDamped || still < 50) return;
  ++counts.at_rest;
  counts.damped += tick.status == Status::kDamped ? 1 : 0;
  counts.largest = std::max(counts.largest, tick.error.cwiseAbs().maxCoeff());
  EXPECT_LE(tick.error.cwiseAbs().maxCoeff(), kLargest) << tick.error.transpose();
}

template <Level kLevel>
[[nodiscard]] auto random_scheme(const JointLimits<N>& limits, Random& random, int k) {
  const double stiffness = random.uniform(0.3, 2.0);
  auto z = NullSpace<N>{}.with_rest_posture(random_posture(limits, random, false), stiffness);
  if (k % 5 == 0) z = z.with_joint_centring(limits, stiffness);
  const Vector<N> W = k % 3 == 0 ? Vector<N>(Vector<N>::Ones(limits.lower.size()))
                                 : Vector<N>(random.uniform(limits.lower.size(), 0.5, 5.0));
  if constexpr (kLevel == Level::kVelocity) {
    return WMVN<N>(W, 5.0, z);
  } else {
    const double alpha = k % 4 == 0 ? 0.0 : k % 4 == 1 ? 1.0 : random.uniform(0.0, 1.0);
    return FPBM<N>(alpha, W, 10.0, 25.0, z.with_damping(2.0 * std::sqrt(stiffness)));
  }
}

template <typename Space, Level kLevel>
void expect_no_error(const std::string& name, const Chain<>& chain) {
  const auto arm = any_arm(chain);
  TrackerOptions<> options;
  options.dt = kTick;
  Count counts;
  for (int k = 0; k < motions(); ++k) {
    SCOPED_TRACE(name + ", motion " + std::to_string(k));
    Random random(static_cast<std::uint32_t>(k));
    const auto scheme = random_scheme<kLevel>(arm.limits(), random, k);
    const Vector<N> q0 = random_posture(arm.limits(), random, false);
    Kinematics<Space, N> kinematics;
    arm.kinematics(random_posture(arm.limits(), random, k % 2 == 1), kinematics);
    CompiledTracker tracker(arm, Space{}, scheme, q0, options);
    count(tracker, Reference<Space>::hold(kinematics.tip), counts);
  }
  std::printf("%s, %s: %d motions, %d at rest, %d of them damped, largest error %.1e\n", name.c_str(),
              kLevel == Level::kVelocity ? "velocities" : "accelerations", counts.motions, counts.at_rest,
              counts.damped, counts.largest);
  EXPECT_GT(counts.at_rest, 0) << name;
}

template <typename Space>
void expect_no_error(const std::string& name, const Chain<>& chain) {
  expect_no_error<Space, Level::kVelocity>(name, chain);
  expect_no_error<Space, Level::kAcceleration>(name, chain);
}

TEST(SecondaryMotion, never_moves_the_tip) {
  for (const presets::Preset& preset : presets::kAll) {
    const Chain<> chain = preset.chain();
    expect_no_error<Position<3>>(std::string(preset.name) + ", position", chain);
    if (any_arm(chain).dof() > Pose::kRows) expect_no_error<Pose>(std::string(preset.name) + ", pose", chain);
  }
}

}  // namespace
}  // namespace fpbm::test::secondary_motion_laws
