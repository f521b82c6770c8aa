#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "fpbm/bound/detail/advancement.hpp"
#include "support/arms.hpp"
#include "support/bodies.hpp"

/// Levers, distances along motions, and the check by advancement.
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

/// The gradient of the gap at the nearest point equals the gradient of the distance.
TEST(Separation, its_gradient_is_that_of_the_distance) {
  int compared = 0;
  for (const auto& [name, tree] : robots()) {
    for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(100)); ++seed) {
      Random random(seed);
      auto clearance = surrounded(tree, random);
      const Joints q = random.uniform(clearance.robot().dof(), -1.5, 1.5);
      auto placed = clearance.placement();
      for (const ShapePair& pair : clearance.pairs()) {
        clearance.place(q, placed);
        const Nearest<> found = clearance.nearest_of(placed, pair);
        const Separation<Clearance<kOpen>> plane(clearance, placed, pair, found);
        if (plane.distance < 0.01) continue;
        EXPECT_NEAR(std::min(plane.gap(0), plane.gap(1)), plane.distance, 1e-12);
        const Joints analytic = clearance.robot().drives().by_drive(plane.of_distance());
        constexpr double kStep = 1e-6;
        for (Eigen::Index i = 0; i < q.size(); ++i) {
          const auto distance = [&](double step) {
            clearance.place(q + step * Joints::Unit(q.size(), i), placed);
            return clearance.nearest_of(placed, pair).distance;
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

/// Whether all pairs keep their margin along the trajectory `displacement` from q.
[[nodiscard]] bool keeps_margins(Clearance<kOpen>& clearance, const Joints& q,
                                 const StopDisplacement<kOpen>& displacement) {
  NearPairs<Clearance<kOpen>> near(clearance);
  near.set_posture(clearance, q);
  return Advancement<Clearance<kOpen>>(clearance).keeps_margins(clearance, near, displacement, 0.0);
}

template <typename Scalar>
[[nodiscard]] Tree<Scalar> tree_in(const Tree<>& tree) {
  Tree<Scalar> result;
  for (const auto& [joint, parent] : tree.joints) {
    Joint<Scalar> cast{joint.type, {}, joint.axis.template cast<Scalar>()};
    cast.placement.p = joint.placement.p.template cast<Scalar>();
    cast.placement.R = joint.placement.R.template cast<Scalar>();
    cast.bounds.lower = static_cast<Scalar>(joint.bounds.lower);
    cast.bounds.upper = static_cast<Scalar>(joint.bounds.upper);
    const auto& [leader, ratio, offset] = joint.mimic;
    cast.mimic = {leader, static_cast<Scalar>(ratio), static_cast<Scalar>(offset)};
    result.joints.push_back({cast, parent});
  }
  return result;
}

/// From posture to posture, with an obstacle that jumps, NearPairs finds the same pairs as distances alone.
template <typename Scalar>
void expect_all_near_pairs() {
  int near_pairs = 0;
  for (const auto& [name, tree] : robots()) {
    std::vector<LinkCapsule<Scalar>> capsules;
    for (const auto& [link, stick, title] : sticks(tree, 0.05)) {
      capsules.push_back(
          {link, {stick.a.template cast<Scalar>(), stick.b.template cast<Scalar>(), Scalar(stick.radius)}, title});
    }
    Capsule<Scalar> post{{Scalar(0.4), Scalar(0), Scalar(0)}, {Scalar(0.4), Scalar(0), Scalar(1)}, Scalar(0.05)};
    for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(40)); ++seed) {
      Random random(seed);
      Clearance<kOpen, Scalar> clearance(tree_in<Scalar>(tree), capsules, {{"post", post}}, Scalar(0.01));
      const Eigen::Index n = clearance.robot().dof();
      const Eigen::Index joints = clearance.robot().joints();
      Vector<kOpen, Scalar> q = random.uniform(n, -1.5, 1.5).template cast<Scalar>();
      NearPairs<Shapes<kOpen, Scalar>> near(clearance);
      auto placed = clearance.placement();
      const double size = std::pow(10.0, random.uniform(-7.0, -1.0));  // From below the round-off of float to 0.1 rad.
      const Joints drift = size * random.uniform(n, -1.0, 1.0);
      for (int k = 0; k < 200; ++k) {
        q += drift.template cast<Scalar>();
        if (seed % 4 == 0 && k % 50 == 49) {
          post.a(1) = post.b(1) = Scalar(random.uniform(-1.0, 1.0));
          ASSERT_TRUE(clearance.move(0, post, Vector<3, Scalar>::Zero()));
        }
        near.set_posture(clearance, q);
        clearance.place(q, placed);
        near.set_displacements(clearance, (random.uniform(0.0, 0.1) * Joints::Ones(joints)).template cast<Scalar>());
        const auto needs = [&](const ShapePair& pair) {
          return clearance.margin() + near.displacement_of(clearance, pair);
        };
        std::vector<std::size_t> found;
        near.each(clearance, needs, [&](std::size_t i, const Nearest<Scalar>& nearest) {
          EXPECT_EQ(nearest.distance, clearance.nearest_of(placed, clearance.pairs()[i]).distance);
          found.push_back(i);
        });
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < clearance.pairs().size(); ++i) {
          const ShapePair& pair = clearance.pairs()[i];
          if (clearance.nearest_of(placed, pair).distance < needs(pair)) expected.push_back(i);
        }
        ASSERT_EQ(found, expected) << name << ", seed " << seed << ", step " << k;
        near_pairs += static_cast<int>(found.size());
      }
    }
  }
  EXPECT_GE(near_pairs, trials(40000));
}

TEST(NearPairs, are_those_of_the_distances_in_double) {
  expect_all_near_pairs<double>();
}
TEST(NearPairs, are_those_of_the_distances_in_float) {
  expect_all_near_pairs<float>();
}

/// If keeps_margins() returns true, no sampled posture of the trajectory is closer than the margin. keeps_margins()
/// returns true for at least 90 % of the trajectories without a sampled violation.
TEST(KeepsMargins, is_never_unsafe_and_rarely_conservative) {
  int sure = 0;
  int clear = 0;
  for (const auto& [name, tree] : robots()) {
    for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(3000)); ++seed) {
      Random random(seed);
      auto clearance = surrounded(tree, random);
      const Eigen::Index n = clearance.robot().dof();
      const Joints q = random.uniform(n, -1.5, 1.5);
      if (!(clearance.nearest_pair(q).second > 0.0)) continue;
      const double size = std::pow(10.0, random.uniform(-2.0, 0.0));
      const Joints none = Joints::Zero(n);
      const Joints unknown = Joints::Constant(n, std::numeric_limits<double>::quiet_NaN());
      StopDisplacement<kOpen> displacement{size * random.uniform(n, -1.0, 1.0),
                                           0.05 * size * random.uniform(n, -1.0, 1.0), none, none, unknown};
      const bool gains = seed % 5 == 0;  // The trajectory includes a tick from rest, as in accepts().
      if (gains) displacement.start_velocity = displacement.line + 2.0 * displacement.ramp_correction;
      const Joints either = 0.02 * size * random.uniform(n, -1.0, 1.0);
      if (seed % 2 == 0) displacement.low = either.cwiseMin(0.0);
      if (seed % 3 == 0) displacement.high = either.cwiseMax(0.0);
      const bool kept = keeps_margins(clearance, q, displacement);
      double least = 1e9;
      for (int place = 0; place < 60; ++place) {
        const double t = random.uniform(0.0, 1.0);
        const Joints rest =
            displacement.low + Joints(random.uniform(n, 0.0, 1.0)).cwiseProduct(displacement.high - displacement.low);
        const double s = place < 30 ? place / 29.0 : t;
        const double most = gains ? std::min(2.0 * s, 1.0) : 1.0;
        const Joints between =
            q + s * displacement.line + random.uniform(0.0, most) * displacement.ramp_correction + rest;
        least = std::min(least, clearance.nearest_pair(between).second);
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

/// If a number is NaN or infinite, keeps_margins() returns false.
TEST(KeepsMargins, returns_false_for_numbers_that_are_not_finite) {
  Random random(5);
  auto clearance = surrounded(tree_of(presets::panda()), random);
  const Joints q = (Joints(7) << 0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8).finished();
  const Joints none = Joints::Zero(7);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int part = 0; part < 4; ++part) {
      StopDisplacement<kOpen> displacement{none, none, none, none, none};
      (part == 0   ? displacement.line
       : part == 1 ? displacement.ramp_correction
       : part == 2 ? displacement.low
                   : displacement.high)(3) = bad;
      EXPECT_FALSE(keeps_margins(clearance, q, displacement)) << "part " << part;
    }
  }
}

}  // namespace
}  // namespace fpbm::test::clearance_laws
