#include "fpbm/bound/detail/torque_deviation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fpbm/limits/detail/stop_advance.hpp"
#include "support/random_tree.hpp"

/// The steps of the certificate of TorqueBounds between two evaluations, on random chains and trees with prismatic
/// joints and joints that follow others.
namespace fpbm::test::torque_deviation_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using Joints = Vector<kOpen>;
using MotionLimits = Limits<Level::kAcceleration, kOpen>;
using Plan = StopPlan<Level::kAcceleration, kOpen>;

/// A random robot with the torques of its drives.
struct RandomRobot {
  Tree<> tree;
  Dynamics<kOpen> model;
  TorqueDeviation<kOpen> deviation;
  Eigen::Index n;

  RandomRobot(const Tree<>& source, const Vector<3>& gravity)
      : tree(source), model(source, gravity), deviation(source, model), n(model.dof()) {}

  /// Without gravity or friction, the bounds on the other terms are seen.
  [[nodiscard]] static RandomRobot with(Random& random, bool gravity, bool friction) {
    constexpr Kind kKinds[] = {{0.0, 0.0, 0.0}, {0.4, 0.0, 0.0}, {0.0, 0.3, 0.0}, {0.3, 0.3, 0.3}};
    const auto joints = static_cast<int>(random.uniform(1.0, random.uniform(0.0, 1.0) < 0.5 ? 3.99 : 8.99));
    Tree<> tree = random_tree(random, joints, kKinds[static_cast<int>(random.uniform(0.0, 3.99))]);
    for (auto& each : tree.joints) {
      if (!friction) each.joint.drive.viscous = 0.0;
      if (each.joint.type == JointType::kPrismatic) {
        each.joint.bounds.lower = -2.0;
        each.joint.bounds.upper = 2.0;
      }
    }
    return {tree, gravity ? Vector<3>(random.uniform(3, -9.0, 9.0)) : Vector<3>(Vector<3>::Zero())};
  }

  [[nodiscard]] Joints torque(const State<kOpen>& state, const Joints& u) const {
    Dynamics<kOpen>::State at;
    model.robot().update(state.q, state.qd, at);
    return model.inverse_dynamics(at, u);
  }
  [[nodiscard]] Matrix<kOpen, kOpen> mass_matrix(const State<kOpen>& state) const {
    Dynamics<kOpen>::State at;
    model.robot().update(state.q, at);
    return model.mass_matrix(at);
  }
};

/// In every tick of a part, the torques for any constant acceleration within the ranges are between the torques at both
/// ends of the part, up to the deviation.
TEST(TorqueDeviation, bounds_the_torques_between_two_ends) {
  Random random(2);
  double closest = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto robot = RandomRobot::with(random, trial % 4 == 0, trial % 4 == 1);
    const auto n = robot.n;
    JointLimits<kOpen> bounds = JointLimits<kOpen>::none(n);
    bounds.velocity.setConstant(3.0);
    bounds.acceleration.setConstant(std::pow(10.0, random.uniform(-1.5, 1.5)));
    if (trial % 3 != 0) bounds.jerk.setConstant(100.0 * bounds.acceleration(0));
    const MotionLimits limits(bounds, 1e-3);
    const State<kOpen> start{random.uniform(n, -1.0, 1.0),
                             std::pow(10.0, random.uniform(-1.5, 0.2)) * random.uniform(n, -1.0, 1.0)};
    const Joints last = random.uniform(0.0, 1.0) * random.uniform(n, -1.0, 1.0) * bounds.acceleration(0);
    Plan plan(limits, start, last, random.uniform(0.1, 1.0));
    StopPart<kOpen> part(start, last);
    const double skipped = std::floor(random.uniform(0.0, 0.9) * plan.ticks_left());
    if (skipped > 0.0) advance(plan, limits, skipped, part);
    const State<kOpen> from = part.state;
    Plan inner = plan;
    const double ticks = std::min(plan.ticks_left(), std::ceil(random.uniform(0.0, trial % 5 == 0 ? 300.0 : 60.0)));
    StopPart<kOpen> to = part;
    advance(plan, limits, ticks, to);
    // M in a posture near the start of the part.
    const Joints near = from.q + random.uniform(0.0, 0.1) * random.uniform(n, -1.0, 1.0);
    const Joints more = robot.deviation.of(robot.mass_matrix({near, from.qd}), near, from.q, to, plan.velocity(),
                                           ticks * limits.tick());
    const Joints u = to.low + random.uniform(n, 0.0, 1.0).cwiseProduct(to.high - to.low);
    const Joints a = robot.torque(from, u);
    const Joints b = robot.torque(to.state, u);
    for (double k = 0.0; k < ticks; k += 1.0) {
      advance(inner, limits, 1.0, part);
      const Joints t = robot.torque(part.state, u);
      const Joints outside = (t - a.cwiseMax(b)).cwiseMax(a.cwiseMin(b) - t);
      ASSERT_LE((outside - more).maxCoeff(), 1e-9) << trial;
      if (more.minCoeff() > 1e-5) closest = std::max(closest, (outside.array() / more.array()).maxCoeff());
    }
  }
  EXPECT_GT(closest, 0.15);  // Some torques leave the interval between both ends, by a part of the deviation.
}

/// The torques in two states differ by at most the difference, for all accelerations of a part.
TEST(TorqueDeviation, bounds_the_torques_near_an_evaluated_state) {
  struct Case {
    bool gravity;
    double acceleration;  ///< [rad/s²] or [m/s²]
    double velocity;      ///< [rad/s] or [m/s]
    bool moved;           ///< Whether the postures differ.
    bool faster;          ///< Whether the velocities differ.
    bool friction;
  };
  constexpr Case kCases[] = {{true, 0.0, 0.0, true, false, false},
                             {false, 15.0, 0.0, true, false, false},
                             {false, 0.0, 2.0, true, false, false},
                             {false, 0.0, 2.0, false, true, false},
                             {true, 15.0, 2.0, true, true, true}};
  for (const Case& each : kCases) {
    Random random(3);
    double closest = 0.0;
    for (int trial = 0; trial < 2000; ++trial) {
      const auto robot = RandomRobot::with(random, each.gravity, each.friction);
      const auto n = robot.n;
      const double size = std::pow(10.0, random.uniform(-4.0, -0.3));
      const State<kOpen> x{random.uniform(n, -2.0, 2.0), each.velocity * random.uniform(n, -1.0, 1.0)};
      const State<kOpen> y{x.q + (each.moved ? size : 0.0) * random.uniform(n, -1.0, 1.0),
                           x.qd + (each.faster ? size : 0.0) * random.uniform(n, -1.0, 1.0)};
      StopPart<kOpen> part(x, x.qd);
      part.low = each.acceleration * random.uniform(n, -1.0, 1.0);
      part.high = part.low + each.acceleration * random.uniform(n, 0.0, 0.5);
      const Joints u = part.low + random.uniform(n, 0.0, 1.0).cwiseProduct(part.high - part.low);
      const Joints more = robot.deviation.between(robot.mass_matrix(x), x, y, part);
      const Joints change = (robot.torque(y, u) - robot.torque(x, u)).cwiseAbs();
      ASSERT_LE((change - more).maxCoeff(), 1e-9) << trial;
      closest = std::max(closest, (change.array() / more.array().max(1e-6)).maxCoeff());
    }
    EXPECT_GT(closest, 0.15);
  }
}

}  // namespace
}  // namespace fpbm::test::torque_deviation_laws
