// A 7-joint arm from a URDF file, in a program without a URDF parser: the tool draws a line with FPBM. This command
// wrote the header:
//   fpbm-cpp export-header examples/04_exported_arm.urdf --tip tool -o examples/04_exported_arm.hpp

#include "04_exported_arm.hpp"

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  constexpr int kDof = exported_arm::kDof;
  const auto arm = exported_arm::arm();
  const fpbm::State<kDof> start{{0.3, 0.4, -0.5, 1.2, 0.4, 0.9, 0.5}, fpbm::Vector<kDof>::Zero()};  // [rad], [rad/s]

  fpbm::Kinematics<fpbm::Position<3>, kDof> kinematics;
  arm.kinematics(start.q, kinematics);
  std::printf("tool at [m]: %.3f %.3f %.3f\n", kinematics.tip(0), kinematics.tip(1), kinematics.tip(2));

  const fpbm::Path path(fpbm::Line<3>({0.1, 0.0, 0.05}), 2.0);     // displacement [m], duration [s]
  const auto damping = fpbm::NullSpace<kDof>().with_damping(2.0);  // [1/s]: the joints stop with the tool
  const auto scheme = fpbm::FPBM<kDof>(0.6, fpbm::UnitWeights{}, 20.0, 100.0, damping);  // alpha, W, k1, k2, z
  const fpbm::TimeGrid grid(path.duration(), 1e-3);

  double max_error = 0.0;
  const auto run = fpbm::rollout(arm, path, scheme, start, grid, [&](const auto& sample) noexcept {
    max_error = std::max(max_error, sample.error.norm());
  });
  if (run.status != fpbm::Status::kOk) {
    std::printf("stopped at %g s: %s. %s\n", run.time, message(run.status), advice(run.status));
    return 1;
  }
  std::printf("largest tool error on the line [m]: %.1e\n", max_error);
  for (int i = 0; i < kDof; ++i) {
    std::printf("%-14s %7.3f rad, %7.3f rad/s\n", exported_arm::kJointNames[static_cast<std::size_t>(i)], run.last.q(i),
                run.last.qd(i));
  }
}
