// Two Pandas carry a tray along a circle. The levels are: grasp, pose of the tray, posture. At the end, the target of
// the tray jumps. The joint limits slow the tray, and the grasp holds.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  const fpbm::Tree<> tree = fpbm::presets::two_pandas();
  const fpbm::Robot<14> robot(tree);
  const auto right = fpbm::frame_of(tree, "right_tip");
  const auto left = fpbm::frame_of(tree, "left_tip");
  const fpbm::Stack stack(fpbm::RelativePoseTask<>{{left, {500.0, 62500.0}}, right},  // k1 [1/s], k2 [1/s²]
                          fpbm::PoseTask<>{right, {40.0, 400.0}}, fpbm::PostureTask<14>{fpbm::TaskGains<>(4.0, 4.0)});
  const auto scheme = fpbm::Balanced<14>(0.0, fpbm::UnitWeights{}, fpbm::NullSpace<14>().with_damping(2.0));
  fpbm::Vector<14> q0;
  q0 << 0.3, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785, -0.3, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785;  // [rad]
  auto tracker = fpbm::stack_tracker(robot, stack, scheme, q0);

  const auto [held, start, posture] = tracker.tip();
  const auto grasp = fpbm::Reference<fpbm::Pose>::hold(held);
  const auto home = fpbm::Reference<fpbm::JointSpace<14>>::hold(posture);
  const fpbm::WithRotation circle(  // Radius [m], duration [s], constant orientation.
      fpbm::InPlane(fpbm::Path(fpbm::Circle(0.1), 6.0), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}));
  fpbm::PathFollower follower(circle, start);
  double slip = 0.0;
  double tray = 0.0;
  double travel = 0.0;
  while (!follower.done()) {
    const auto tick = tracker.tick(grasp, follower, home);
    slip = std::max(slip, tick.error.head<6>().norm());
    tray = std::max(tray, tick.error.segment<6>(6).norm());
    travel = std::max(travel, (tick.q - q0).cwiseAbs().maxCoeff());
  }
  std::printf("circle: grasp off by at most %.0e m and rad, tray by %.0e; joints travel by up to %.2f rad\n", slip,
              tray, travel);

  fpbm::Transform<> there = std::get<1>(tracker.tip());
  there.p += fpbm::Vector<3>(0.05, -0.1, 0.15);  // [m]
  const auto goal = fpbm::Reference<fpbm::Pose>::hold(there);
  int slowed = 0;
  fpbm::Status status = fpbm::Status::kOk;
  slip = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const auto tick = tracker.tick(grasp, goal, home);
    slip = std::max(slip, tick.error.head<6>().norm());
    tray = tick.error.segment<6>(6).norm();
    slowed += tick.scales[1] < 1.0 ? 1 : 0;
    status = tick.status;
  }
  std::printf("jump: the tray slowed in %d ticks, off by %.0e at the end; grasp off by at most %.0e\n", slowed, tray,
              slip);
  return fpbm::failed(status) ? 1 : 0;
}
