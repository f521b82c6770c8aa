// A Panda glues along the rim of a cover, at a constant speed where the joints allow it, and slower in corners.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fpbm/fpbm.hpp>
#include <vector>

int main() {
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  const fpbm::JointLimits<7>& limits = arm.limits();
  const fpbm::Vector<7> q0{0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785};  // [rad], the tool points down
  const std::vector<fpbm::Vector<3>> corners{{0.0, 0.0, 0.0},    {0.0, 0.08, 0.0},  {0.12, 0.08, 0.0},
                                             {0.12, 0.02, 0.0},  {0.08, 0.0, 0.0},  {0.12, -0.02, 0.0},
                                             {0.12, -0.08, 0.0}, {0.0, -0.08, 0.0}, {0.0, 0.0, 0.0}};  // [m]
  const fpbm::Polyline<fpbm::Position<3>> rim(corners, 0.005);           // Blends of 5 mm.
  const fpbm::WithRotation seam(fpbm::Path(rim, 1.0, fpbm::Quintic{}));  // Only the geometry counts, not the duration.
  constexpr double kSpeed = 0.15;                                        // [m/s]

  fpbm::FastestOptions options;  // 1 kHz
  options.tip_speed = kSpeed;
  fpbm::Vector<3> place = fpbm::Vector<3>::Zero();
  fpbm::Vector<7> acceleration = fpbm::Vector<7>::Zero();
  int steady = 0;
  double error = 0.0;
  double ratio = 0.0;
  const auto record = [&](const auto& sample) {
    const auto use = [&](const fpbm::Vector<7>& value, const fpbm::Vector<7>& bound) {
      ratio = std::max(ratio, value.cwiseAbs().cwiseQuotient(bound).maxCoeff());
    };
    if (sample.index > 0) {
      const double speed = (sample.tip.p - place).norm() / options.dt;
      steady += std::abs(speed / kSpeed - 1.0) < 0.01 ? 1 : 0;
      use((sample.qdd - acceleration) / options.dt, limits.jerk);
    }
    use(sample.qd, limits.velocity);
    use(sample.qdd, limits.acceleration);
    error = std::max(error, sample.error.template head<3>().norm());
    place = sample.tip.p;
    acceleration = sample.qdd;
    return true;
  };
  fpbm::Bounds<> bounds;
  const auto result = fpbm::fastest(arm, seam, fpbm::MVN<7>(), q0, limits, bounds, options, record);
  std::printf(
      "fastest: %.2f s, %.0f%% of the time within 1 %% of the speed, at most %.0e m from the seam, largest ratio to a "
      "bound %.4f\n",
      result.time, 100.0 * steady / (result.samples - 1), error, ratio);
  return fpbm::failed(result.status) ? 1 : 0;
}
