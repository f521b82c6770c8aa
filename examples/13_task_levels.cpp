// A Panda carries a cup. The levels are: cup upright, position of the tip, height of the elbow, posture. Joint limits
// slow the lower levels, and the cup stays upright.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  const fpbm::Robot<7> robot(fpbm::presets::panda());
  constexpr int kTip = fpbm::Robot<7>::kTip;
  const fpbm::TaskGains<> gains(10.0, 25.0);  // k1 [1/s], k2 [1/s²]
  const fpbm::Stack stack(fpbm::AxisTask<>{{kTip}, gains}, fpbm::PositionTask<>{{kTip}, gains},
                          fpbm::PositionTask<1>{{4}, gains, {2}},  // z of link 4, the elbow
                          fpbm::PostureTask<7>{fpbm::TaskGains<>(4.0, 4.0)});
  const auto scheme = fpbm::Balanced<7>(0.6, fpbm::UnitWeights{}, fpbm::NullSpace<7>().with_damping(2.0));
  const fpbm::Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};  // [rad]
  auto tracker = fpbm::stack_tracker(robot, stack, scheme, q0);

  const auto [axis, place, elbow, posture] = tracker.tip();
  const auto upright = fpbm::Reference<fpbm::Direction>::hold(axis);
  const auto goal = fpbm::Reference<fpbm::Position<3>>::hold(place + fpbm::Vector<3>(0.2, 0.3, -0.1));
  const auto height = fpbm::Reference<fpbm::Position<3>>::hold(elbow);
  const auto home = fpbm::Reference<fpbm::JointSpace<7>>::hold(posture);
  double tilt = 0.0;
  int slowed = 0;
  fpbm::Status status = fpbm::Status::kOk;
  for (int i = 0; i < 8000; ++i) {
    const auto tick = tracker.tick(upright, goal, height, home);
    tilt = std::max(tilt, tick.error.head<3>().norm());
    slowed += std::min({tick.scales[1], tick.scales[2], tick.scales[3]}) < 1.0 ? 1 : 0;
    status = tick.status;
  }
  const auto [a, x, z, q] = tracker.tip();
  std::printf("tilt at most %.0e rad; a lower level slowed in %d ticks; place off by %.0e m, elbow by %.3f m\n", tilt,
              slowed, (goal.x - x).norm(), elbow(2) - z(2));
  return fpbm::failed(status) ? 1 : 0;
}
