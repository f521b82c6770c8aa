// A Kinova Gen3 draws a Lissajous figure with a free orientation of the tip, and returns to its start posture.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

using Joints = fpbm::Vector<7>;

/// Draws the figure by FPBM with a secondary motion and prints key figures. Returns false if the motion stops early.
bool run(const char* name, const Joints& home, const fpbm::NullSpace<7>& secondary) {
  const fpbm::SerialArm<7> arm(fpbm::presets::gen3());
  const fpbm::Lissajous<double> figure({0.15, 0.1}, {1, 2}, 0.0);  // amplitudes [m], frequencies, phase [rad]
  const fpbm::InPlane path(fpbm::Path(figure, 8.0, fpbm::Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0});
  const fpbm::TimeGrid grid(path.duration(), 1e-3, 4.0);
  const auto scheme = fpbm::FPBM<7>(0.6, fpbm::UnitWeights{}, 20.0, 100.0, secondary);  // alpha, W, k1, k2, z

  double error = 0.0, speed = 0.0;
  const auto result = fpbm::rollout(arm, path, scheme, {home, Joints::Zero()}, grid, [&](const auto& sample) noexcept {
    error = std::max(error, sample.error.norm());
    speed = std::max(speed, sample.qd.cwiseAbs().maxCoeff());
  });
  if (result.status != fpbm::Status::kOk) {
    std::printf("%s stopped at %g s: %s. %s\n", name, result.time, message(result.status), advice(result.status));
    return false;
  }
  std::printf("%s: tip error %.0e m; fastest joint %.3f rad/s, at the end %.0e rad/s and %.0e rad from home\n", name,
              error, speed, result.last.qd.cwiseAbs().maxCoeff(), (result.last.q - home).cwiseAbs().maxCoeff());
  return true;
}

int main() {
  constexpr double kPi = fpbm::kTwoPi / 2.0;
  const Joints home{0.0, 0.26, kPi, -2.27, 0.0, 0.96, kPi / 2};  // [rad]
  const fpbm::NullSpace<7> nothing;
  const auto homeward = nothing.with_damping(4.0).with_rest_posture(home, 4.0);

  // The task determines three of the seven degrees of freedom. Without a secondary motion, the four others end in
  // another posture, and still move when the tip is at rest.
  return run("no secondary motion", home, nothing) && run("rest posture", home, homeward) ? 0 : 1;
}
