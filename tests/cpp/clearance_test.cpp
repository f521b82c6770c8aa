#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "fpbm/clearance/advance.hpp"
#include "support/arms.hpp"
#include "support/bodies.hpp"

/// Levers, distances along motions, and what is sure of them.
namespace fpbm::test::clearance_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using Joints = Vector<kOpen>;

struct Case {
  std::string name;
  Tree<> tree;
};

[[nodiscard]] std::vector<Case> robots() {
  return {{"panda", tree_of(presets::panda())}, {"ur5e", tree_of(presets::ur5e())},
          {"rail", tree_of(panda_on_rail())},   {"coupled", tree_of(coupled_panda())},
          {"two on a torso", two_pandas(true)}, {"two", two_pandas(false)}};
}

[[nodiscard]] Clearance<kOpen> surrounded(const Tree<>& tree, Random& random) {
  std::vector<Obstacle<>> obstacles;
  for (int k = 0; k < 3; ++k) obstacles.push_back(random_obstacle(random, 1.5, k));
  return {tree, sticks(tree, 0.05), obstacles, 0.0};
}

TEST(Levers, bound_how_far_joints_move_points) {
  for (const auto& [name, tree] : robots()) {
    SCOPED_TRACE(name);
    const Robot<kOpen> robot(tree);
    const Levers<> levers_of(tree);
    Random random(3);
    double tightest = 1e9;
    for (int trial = 0; trial < trials(2000); ++trial) {
      Joints q(robot.dof());
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const double low = std::max(robot.limits().lower(i), -3.0);
        q(i) = low + random.uniform(0.0, 1.0) * (std::min(robot.limits().upper(i), 3.0) - low);
      }
      RobotState<kOpen> state;
      robot.update(q, state);
      const int link = 1 + trial % robot.joints();
      const Vector<3> point = random.uniform(3, -0.2, 0.2);
      const auto levers = levers_of(link, point);
      Transform<> offset;
      offset.p = point;
      const Vector<3> x = robot.point(state, link, robot.in_joint(link, offset).p);
      for (Eigen::Index k = 0; k < robot.joints(); ++k) {
        const auto joint = static_cast<std::size_t>(k + 1);
        const Vector<3> z = state.R[joint].col(2);
        const Vector<3> arm = x - state.p[joint];
        const bool moved = (robot.moved_by(link) >> k & 1U) != 0;
        const double moves = !moved ? 0.0 : robot.turns(k) ? cross(z, arm).norm() : 1.0;
        ASSERT_LE(moves, levers(k) + 1e-12) << "joint " << k << " of link " << link;
        ASSERT_EQ(moved, levers(k) > 0.0);
        if (moves > 0.0) tightest = std::min(tightest, levers(k) / moves);
      }
    }
    EXPECT_LE(tightest, 1.01);
  }
}

/// The gradient of the nearest point's gap is that of the distance.
TEST(Separation, its_gradient_is_that_of_the_distance) {
  int compared = 0;
  for (const auto& [name, tree] : robots()) {
    for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(100)); ++seed) {
      Random random(seed);
      auto clearance = surrounded(tree, random);
      const Joints q = random.uniform(clearance.robot().dof(), -1.5, 1.5);
      clearance.place(q);
      for (const ShapePair& pair : clearance.pairs()) {
        clearance.place(q);
        const Separation<kOpen, double> plane(clearance, pair);
        if (plane.distance < 0.01) continue;
        EXPECT_NEAR(std::min(plane.gap(0), plane.gap(1)), plane.distance, 1e-12);
        const Joints analytic = clearance.robot().drives().by_drive(plane.of_distance());
        constexpr double kStep = 1e-6;
        for (Eigen::Index i = 0; i < q.size(); ++i) {
          const auto distance = [&](double step) {
            clearance.place(q + step * Joints::Unit(q.size(), i));
            return clearance.nearest_of(pair).distance;
          };
          const double forward = (distance(kStep) - plane.distance) / kStep;
          const double backward = (plane.distance - distance(-kStep)) / kStep;
          if (std::abs(forward - backward) > 1e-4) continue;  // The nearest points jump.
          ASSERT_NEAR(analytic(i), (forward + backward) / 2.0, 1e-4) << name << ", seed " << seed << ", joint " << i;
          ++compared;
        }
      }
    }
  }
  EXPECT_GE(compared, trials(40000));
}

/// Where keeps_apart() says so, no place in the sweep is nearer than the margin; and it says so nearly as often as it
/// is so.
TEST(KeepsApart, is_never_wrong_and_seldom_shy) {
  int sure = 0;
  int clear = 0;
  for (const auto& [name, tree] : robots()) {
    for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(3000)); ++seed) {
      Random random(seed);
      auto clearance = surrounded(tree, random);
      const Eigen::Index n = clearance.robot().dof();
      const Joints q = random.uniform(n, -1.5, 1.5);
      clearance.place(q);
      if (!(clearance.nearest_pair().second > 0.0)) continue;
      const double size = std::pow(10.0, random.uniform(-2.0, 0.0));
      const Joints none = Joints::Zero(n);
      const Joints unknown = Joints::Constant(n, std::numeric_limits<double>::quiet_NaN());
      Sweep<kOpen> sweep{size * random.uniform(n, -1.0, 1.0), 0.05 * size * random.uniform(n, -1.0, 1.0), none, none,
                         unknown};
      const bool gains = seed % 5 == 0;  // Joints begin to move, as in a tick.
      if (gains) sweep.begun = sweep.way + 2.0 * sweep.tick;
      const Joints either = 0.02 * size * random.uniform(n, -1.0, 1.0);
      if (seed % 2 == 0) sweep.low = either.cwiseMin(0.0);
      if (seed % 3 == 0) sweep.high = either.cwiseMax(0.0);
      const bool kept = keeps_apart(clearance, q, sweep, 0.0);
      double least = 1e9;
      for (int place = 0; place < 60; ++place) {
        const double t = random.uniform(0.0, 1.0);
        const Joints rest = sweep.low + Joints(random.uniform(n, 0.0, 1.0)).cwiseProduct(sweep.high - sweep.low);
        const double s = place < 30 ? place / 29.0 : t;
        const double most = gains ? std::min(2.0 * s, 1.0) : 1.0;
        clearance.place(q + s * sweep.way + random.uniform(0.0, most) * sweep.tick + rest);
        least = std::min(least, clearance.nearest_pair().second);
      }
      if (kept) {
        ASSERT_GE(least, 0.0) << name << ", seed " << seed;
      }
      sure += kept;
      clear += least > 0.0;
    }
  }
  EXPECT_GE(sure, 0.9 * clear);
  std::printf("sure of %d of %d sweeps that are clear\n", sure, clear);
}

/// Numbers that are none make it unsure.
TEST(KeepsApart, is_unsure_of_what_is_not_finite) {
  Random random(5);
  auto clearance = surrounded(tree_of(presets::panda()), random);
  const Joints q = (Joints(7) << 0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8).finished();
  const Joints none = Joints::Zero(7);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int part = 0; part < 4; ++part) {
      Sweep<kOpen> sweep{none, none, none, none, none};
      (part == 0 ? sweep.way : part == 1 ? sweep.tick : part == 2 ? sweep.low : sweep.high)(3) = bad;
      clearance.place(q);
      EXPECT_FALSE(keeps_apart(clearance, q, sweep, 0.0)) << "part " << part;
    }
  }
}

}  // namespace
}  // namespace fpbm::test::clearance_laws
