// A Panda on a mobile base wipes a table: the tip follows 3 m of strokes, and points down. Velocity and acceleration of
// the base are bounded. The weights of the scheme determine how much the base moves: a joint with a larger weight moves
// less.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>
#include <string>

constexpr int kDof = 10;
using Joints = fpbm::Vector<kDof>;

/// A joint of the base, without bounds on position.
fpbm::TreeJoint<> base_joint(const std::string& name, fpbm::JointType type, const fpbm::Vector<3>& axis, int parent,
                             double velocity, double acceleration) {
  fpbm::TreeJoint<> each;
  each.joint.name = name;
  each.joint.type = type;
  each.joint.axis = axis;
  each.joint.bounds.velocity = velocity;          // [m/s] or [rad/s]
  each.joint.bounds.acceleration = acceleration;  // [m/s²] or [rad/s²]
  each.parent = parent;
  return each;
}

fpbm::Tree<> mobile_panda() {
  using fpbm::JointType;
  fpbm::Tree<> tree;
  tree.joints = {base_joint("base_x", JointType::kPrismatic, {1.0, 0.0, 0.0}, 0, 0.2, 0.3),
                 base_joint("base_y", JointType::kPrismatic, {0.0, 1.0, 0.0}, 1, 0.2, 0.3),
                 base_joint("base_yaw", JointType::kContinuous, {0.0, 0.0, 1.0}, 2, 0.5, 0.6)};
  fpbm::Chain<> arm = fpbm::presets::panda();
  for (auto& joint : arm.joints) joint.bounds.jerk = fpbm::JointBounds<>::kNone;
  add_arm(tree, arm, "arm", 3);
  return tree;
}

/// Wipes with a weight of the base joints, and prints errors and base motion. Returns false if the robot stops early.
bool wipe(const char* name, double weight) {
  const auto tree = mobile_panda();
  const fpbm::Robot<kDof> robot(tree);
  const auto tip = fpbm::frame_of(tree, "arm_tip");
  const fpbm::TaskGains<> gains(40.0, 400.0);  // k1 [1/s], k2 [1/s²]
  const fpbm::Stack stack(fpbm::TaskLevel(fpbm::PositionTask<>{tip, gains}, fpbm::AxisTask<>{tip, gains}));
  Joints weights = Joints::Ones();
  weights.head<3>().setConstant(weight);
  const auto scheme = fpbm::Balanced<kDof>(1.0, weights, fpbm::NullSpace<kDof>().with_damping(2.0));
  const Joints q0{0.0, 0.0, 0.0, 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};  // x, y [m], yaw, joints [rad]
  auto tracker = fpbm::stack_tracker(robot, stack, scheme, q0);           // 1 kHz

  const auto here = fpbm::Reference<fpbm::Position<3>>::hold(std::get<0>(tracker.tip()));
  const auto down = fpbm::Reference<fpbm::Direction>::hold(fpbm::Vector<3>(0.0, 0.0, -1.0));
  for (int i = 0; i < 1500; ++i) (void)tracker.tick(here, down);  // Until the tip points down.

  const fpbm::Path there(fpbm::Line<3>({0.35, 0.0, 0.0}), 1.5);  // [m], [s]
  const fpbm::Path back(fpbm::Line<3>({-0.35, 0.0, 0.0}), 1.5);
  const fpbm::Path on(fpbm::Line<3>({0.0, 0.15, 0.0}), 1.2);
  const fpbm::Sequence lap(fpbm::Sequence(there, on), fpbm::Sequence(back, on));
  fpbm::PathFollower strokes(fpbm::Sequence(fpbm::Sequence(lap, lap), lap), std::get<0>(tracker.tip()));
  double error = 0.0, tilt = 0.0, travel = 0.0, speed = 0.0, acceleration = 0.0;
  Joints before = tracker.state().q;
  Joints qd_before = tracker.state().qd;
  fpbm::Status status = fpbm::Status::kOk;
  while (!strokes.done()) {
    const auto tick = tracker.tick(strokes, down);
    error = std::max(error, tick.error.head<3>().norm());
    tilt = std::max(tilt, tick.error.segment<3>(3).norm());
    const Joints qd = (tick.q - before) / 1e-3;
    travel += (tick.q - before).head<2>().norm();
    speed = std::max(speed, qd.head<2>().cwiseAbs().maxCoeff());
    acceleration = std::max(acceleration, (qd - qd_before).head<2>().cwiseAbs().maxCoeff() / 1e-3);
    before = tick.q;
    qd_before = qd;
    status = tick.status;
  }
  std::printf(
      "%s: tip off by at most %.0e m, tilt %.0e rad over 3 m; base travels %.2f m, at most %.3f m/s and %.3f m/s^2 "
      "along an axis\n",
      name, error, tilt, travel, speed, acceleration);
  return !fpbm::failed(status);
}

int main() {
  const bool light = wipe("light base", 0.05);
  const bool heavy = wipe("heavy base", 60.0);
  return light && heavy ? 0 : 1;
}
