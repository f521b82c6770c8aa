// A Panda carries an upright cup to a target and back. A wall bounds the elbow, and the tip has at most 0.5 m/s.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  const fpbm::Chain<> chain = fpbm::presets::panda();
  const fpbm::Robot<7> robot(chain);
  constexpr int kTip = fpbm::Robot<7>::kTip;
  const fpbm::TaskGains<> gains(10.0, 25.0);  // k1 [1/s], k2 [1/s²]
  const fpbm::Stack stack(fpbm::AxisTask<>{{kTip}, gains}, fpbm::PositionTask<>{{kTip}, gains},
                          fpbm::PostureTask<7>{fpbm::TaskGains<>(4.0, 4.0)});
  const auto scheme = fpbm::Balanced<7>(0.6, fpbm::UnitWeights{}, fpbm::NullSpace<7>().with_damping(2.0));
  const fpbm::Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};  // [rad]

  fpbm::PositionBounds<> wall{{4}};  // Of link 4, the elbow.
  wall.upper(1) = 0.04;              // [m]
  wall.deceleration = 1.0;           // [m/s²]
  fpbm::TaskBounds<7> walls(chain);
  walls.keep(wall);
  fpbm::SpeedBounds<7> speeds(chain);
  speeds.keep({{kTip}, 0.5});  // [m/s]

  const fpbm::TrackerOptions<> options;  // 1 kHz
  const fpbm::Limits<fpbm::Level::kAcceleration, 7> limits(robot.limits(), options.dt);
  const fpbm::Vector<7> rest = fpbm::Vector<7>::Zero();
  auto tracker = fpbm::stack_tracker(robot, stack, scheme, fpbm::State<7>{q0, rest}, options, limits, rest,
                                     fpbm::Bounds(walls, speeds));

  const auto [axis, start, posture] = tracker.tip();
  const auto upright = fpbm::Reference<fpbm::Direction>::hold(axis);
  const auto there = fpbm::Reference<fpbm::Position<3>>::hold(start + fpbm::Vector<3>(0.05, 0.35, 0.1));
  const auto back = fpbm::Reference<fpbm::Position<3>>::hold(start);
  const auto home = fpbm::Reference<fpbm::JointSpace<7>>::hold(posture);
  double tilt = 0.0;
  double off = 0.0;
  int slowed = 0;
  fpbm::Status status = fpbm::Status::kOk;
  for (int i = 0; i < 12000; ++i) {
    const auto tick = tracker.tick(upright, i < 6000 ? there : back, home);
    tilt = std::max(tilt, tick.error.head<3>().norm());
    slowed += *std::min_element(tick.scales.begin(), tick.scales.end()) < 1.0 ? 1 : 0;
    if (i == 5999) off = tick.error.segment<3>(3).norm();
    status = tick.status;
  }
  const auto [a, place, q] = tracker.tip();
  std::printf(
      "tilt at most %.0e rad; levels slowed in %d ticks; place off by %.2f m behind the wall, by %.0e m after the "
      "return\n",
      tilt, slowed, off, (start - place).norm());
  return fpbm::failed(status) ? 1 : 0;
}
