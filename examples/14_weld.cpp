// A UR5e welds along a circle: the torch points down, and its rotation about its axis is free.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  const fpbm::Robot<6> robot(fpbm::presets::ur5e());
  constexpr int kTip = fpbm::Robot<6>::kTip;
  const fpbm::TaskGains<> gains(20.0, 100.0);  // k1 [1/s], k2 [1/s²]
  // Position and axis on one level (5 rows), then the posture.
  const fpbm::Stack stack(fpbm::TaskLevel(fpbm::PositionTask<>{{kTip}, gains}, fpbm::AxisTask<>{{kTip}, gains}),
                          fpbm::PostureTask<6>{fpbm::TaskGains<>(4.0, 4.0)});
  const auto scheme = fpbm::Balanced<6>(0.6, fpbm::UnitWeights{}, fpbm::NullSpace<6>().with_damping(2.0));
  const fpbm::Vector<6> q0{0.0, -1.2, 1.8, -2.2, -1.5, 0.3};  // [rad]
  auto tracker = fpbm::stack_tracker(robot, stack, scheme, q0);

  const auto here = fpbm::Reference<fpbm::Position<3>>::hold(std::get<0>(tracker.tip()));
  const auto down = fpbm::Reference<fpbm::Direction>::hold(fpbm::Vector<3>(0.0, 0.0, -1.0));
  const auto posture = fpbm::Reference<fpbm::JointSpace<6>>::hold(q0);
  for (int i = 0; i < 3000; ++i) (void)tracker.tick(here, down, posture);
  const double turned = (std::get<1>(tracker.tip()) - down.x).norm();

  fpbm::PathFollower seam(fpbm::InPlane(fpbm::Path(fpbm::Circle(0.1), 8.0), {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}),
                          std::get<0>(tracker.tip()));
  double error = 0.0;
  fpbm::Status status = fpbm::Status::kOk;
  while (!seam.done()) {
    const auto tick = tracker.tick(seam, down, posture);
    error = std::max({error, tick.error.head<3>().norm(), tick.error.segment<3>(3).norm()});
    status = tick.status;
  }
  std::printf("torch %.0e from straight down before the seam; errors at most %.0e m and rad along the seam\n", turned,
              error);
  return fpbm::failed(status) ? 1 : 0;
}
