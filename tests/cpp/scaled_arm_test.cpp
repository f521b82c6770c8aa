#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// An arm of another size, or in other units, moves in proportion.
namespace fpbm::test::scaled_arm_laws {
namespace {

/// Statuses of all ticks, the joint displacements, and the largest position error in arm lengths.
struct Course {
  std::vector<Status> statuses;
  Vector<Eigen::Dynamic> q;
  double error = 0.0;
};

/// Through a singular posture to an unreachable target and back, then along a circle.
template <typename Space, typename Arm, typename Scheme>
[[nodiscard]] Course run(const Arm& arm, const Scheme& scheme, const Vector<Eigen::Dynamic>& q0, double factor) {
  constexpr int N = Arm::kDof;
  constexpr int kLengths = Space::kRows - Space::kTurns;
  auto bounds = arm.limits();
  for (Eigen::Index i = 0; i < q0.size(); ++i) bounds.set(i, {-2.9, 2.9, 2.0, 10.0});
  const Limits<Scheme::kLevel, N> limits(bounds, 1e-3);
  CompiledTracker tracker(arm, Space{}, scheme, State<N>{q0, Vector<N>::Zero(q0.size())}, {}, limits);
  const auto home = Reference<Space>::hold(tracker.tip());
  Course course;
  for (int i = 0; i < 6000; ++i) {
    auto reference = home;
    Vector<Space::kRows> away = Vector<Space::kRows>::Zero();
    away(0) = factor * (i < 2000 ? 3.0 : 0.0);
    if (i >= 4000) away(kLengths - 1) = factor * 0.1 * std::sin(0.002 * (i - 4000));
    reference.x = Space::template displace<double>(home.x, away);
    const auto tick = tracker.tick(reference);
    course.statuses.push_back(tick.status);
    if (i >= 4000) course.error = std::max(course.error, tick.error.template head<kLengths>().norm() / factor);
  }
  course.q = tracker.state().q;
  return course;
}

template <typename Space, typename MakeArm>
void expect_the_same_at_every_size(MakeArm&& make_arm, const Vector<Eigen::Dynamic>& q0) {
  const auto check = [&](const auto& scheme) {
    const Course plain = run<Space>(make_arm(1.0), scheme, q0, 1.0);
    for (const double factor : {0.0625, 0.25, 16.0, 1024.0}) {  // Powers of two do not change the digits.
      const Course scaled = run<Space>(make_arm(factor), scheme, q0, factor);
      EXPECT_EQ(scaled.statuses, plain.statuses) << factor;
      EXPECT_NEAR(scaled.error, plain.error, 1e-9 * (1.0 + plain.error)) << factor;
      EXPECT_LE((scaled.q - plain.q).norm(), 1e-6) << factor;
    }
    EXPECT_GT(std::count(plain.statuses.begin(), plain.statuses.end(), Status::kDamped) +
                  std::count(plain.statuses.begin(), plain.statuses.end(), Status::kSlowed),
              0);
  };
  using Joints = Vector<Eigen::Dynamic>;
  const Joints ones = Joints::Ones(q0.size());
  check(FPBM<Eigen::Dynamic>(0.6, ones, 10.0, 25.0, NullSpace<Eigen::Dynamic>().with_damping(2.0)));
  check(WMVN<Eigen::Dynamic>(ones, 5.0));
}

[[nodiscard]] AnyArm<Position<3>> scaled(Chain<> chain, double factor) {
  for (Joint<>& joint : chain.joints) joint.placement.p *= factor;
  chain.tip.p *= factor;
  return any_arm(chain);
}

TEST(ScaledArm, moves_equally_at_every_size_in_space) {
  Vector<Eigen::Dynamic> q0(7);
  q0 << 0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785;
  const auto panda = [](double factor) { return scaled(presets::panda(), factor); };
  expect_the_same_at_every_size<Pose>(panda, q0);
  expect_the_same_at_every_size<Position<3>>(panda, q0);
  Vector<Eigen::Dynamic> bent(6);
  bent << 0.1, -1.3, 1.7, -0.9, 1.1, 0.3;
  expect_the_same_at_every_size<Pose>([](double factor) { return scaled(presets::ur5e(), factor); }, bent);
}

TEST(ScaledArm, moves_equally_at_every_size_in_the_plane) {
  Vector<Eigen::Dynamic> q0(3);
  q0 << 0.3, 0.8, 0.5;
  const auto planar = [](double factor) { return any_planar_arm(factor * Vector<Eigen::Dynamic>::Ones(3)); };
  expect_the_same_at_every_size<Position<2>>(planar, q0);
  expect_the_same_at_every_size<PlanarPose>(planar, q0);
}

}  // namespace
}  // namespace fpbm::test::scaled_arm_laws
