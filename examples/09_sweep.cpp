// A Panda on a circle from eleven start postures: MAN (alpha = 0) to WMVN (alpha = 1), undamped and damped.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  const fpbm::InPlane circle(fpbm::Path(fpbm::Circle(0.15), 4.0), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0});  // [m], [s]
  const fpbm::WithRotation path(circle);
  const fpbm::TimeGrid grid(path.duration(), 1e-3, 1.0);
  fpbm::State<7> start{{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785}, fpbm::Vector<7>::Zero()};  // [rad]

  // Twelve schemes from eleven starts. Each motion is summarised during its computation, and no sample is stored.
  std::printf("damping  alpha  complete  error [m]  peak qd [rad/s]  final qd [rad/s]  manipulability\n");
  for (const double damping : {0.0, 2.0}) {
    for (const double alpha : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
      const auto damped = fpbm::NullSpace<7>().with_damping(damping);
      const auto scheme = fpbm::FPBM<7>(alpha, fpbm::Vector<7>::Ones(), 10.0, 25.0, damped);
      int complete = 0;
      double error = 0.0, peak = 0.0, final = 0.0, least = 1.0;
      for (int i = 0; i < 11; ++i) {
        start.q(2) = 0.1 * i - 0.5;
        fpbm::Summary<fpbm::Pose, 7> summary(fpbm::Level::kAcceleration);
        const auto result = fpbm::rollout(arm, path, scheme, start, grid, summary);
        complete += failed(result.status) ? 0 : 1;
        const auto motion = summary.result();
        error = std::max(error, motion.max_error);
        peak = std::max(peak, motion.peak_velocity);
        final = std::max(final, motion.final_velocity);
        least = std::min(least, motion.manipulability);
      }
      std::printf("%7.1f  %5.1f  %8d  %9.0e  %15.3f  %16.4f  %14.4f\n", damping, alpha, complete, error, peak, final,
                  least);
    }
  }
  return 0;
}
