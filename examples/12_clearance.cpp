// The reference of a Panda passes through a post and into a table: motions without and with collision avoidance.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>
#include <vector>

using Joints = fpbm::Vector<7>;
using Clearance = fpbm::Clearance<7>;

/// Draws the line and avoids the shapes of `kept`. Prints and returns the smallest distance in `measured`.
double run(const char* name, const Clearance& kept, Clearance measured) {
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  const Joints q0{0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854}, rest = Joints::Zero();  // [rad]
  const fpbm::Limits<fpbm::Level::kAcceleration, 7> limits(arm.limits(), 1e-3);
  const auto scheme = fpbm::FPBM<7>(0.6, fpbm::UnitWeights{}, 10.0, 25.0, fpbm::NullSpace<7>().with_damping(2.0));
  fpbm::Tracker tracker(arm, fpbm::Position<3>{}, scheme, fpbm::State<7>{q0, rest}, {}, limits, rest,
                        fpbm::Bounds(kept));

  const fpbm::Path line(fpbm::Line<3>({0.3, 0.2, -0.4}), 2.0);  // displacement [m], duration [s]
  fpbm::PathFollower follower(line, tracker.tip(), 1e-3);
  double nearest = 1.0, error = 0.0;
  const auto record = [&](const auto& sample, const auto&) noexcept {
    nearest = std::min(nearest, measured.nearest_pair(sample.q).second);
    error = sample.error.norm();
  };
  const auto result = fpbm::track(tracker, follower, fpbm::TimeGrid(line.duration(), 1e-3, 1.0), record);
  std::printf("%s: nearest %.3f m, at the end %.3f m from the target: %s\n", name, nearest, error,
              message(result.status));
  return nearest;
}

int main() {
  const std::vector<fpbm::Obstacle<>> around{
      {"table", fpbm::HalfSpace<>{{0.0, 0.0, 1.0}, 0.2}},                 // normal, offset [m]
      {"post", fpbm::Capsule<>{{0.6, 0.0, 0.0}, {0.6, 0.0, 0.5}, 0.05}},  // ends, radius [m]
  };
  const auto panda = fpbm::presets::panda();
  const auto capsules = fpbm::presets::capsules::panda();
  const Clearance clearance(panda, capsules, around, 0.01, fpbm::presets::never_collide::panda());  // margin [m]
  const Clearance nothing(panda, {}, {}, 0.0);

  run("no clearance", nothing, clearance);
  return run("kept clear", clearance, clearance) >= 0.01 - 1e-9 ? 0 : 1;
}
