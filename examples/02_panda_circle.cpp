// A Panda draws a circle twice with a constant orientation, then holds the tip: four schemes in one table.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fpbm/fpbm.hpp>

using Joints = fpbm::Vector<7>;

/// Moves the Panda with a scheme and prints the key figures. Returns false if the motion stops early.
template <typename Scheme>
bool run(const char* name, const Scheme& scheme, const Joints& start) {
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  const fpbm::InPlane circle(fpbm::Path(fpbm::Circle(0.12), 3.0, fpbm::Quintic{}),  // radius [m], duration [s]
                             {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  const fpbm::WithRotation path(fpbm::Sequence(circle, circle));  // Twice, with a constant orientation.
  const fpbm::TimeGrid grid(path.duration(), 1e-3, 4.0);

  double speed = 0.0, acceleration = 0.0, error = 0.0, orientation_error = 0.0, manipulability = 1.0;
  Joints before = Joints::Zero();
  fpbm::Kinematics<fpbm::Pose, 7> kinematics;
  const auto result = fpbm::rollout(arm, path, scheme, {start, before}, grid, [&](const auto& sample) noexcept {
    speed = std::max(speed, sample.qd.norm());
    acceleration = std::max(acceleration, (sample.qd - before).norm() / grid.dt());
    before = sample.qd;
    error = std::max(error, sample.error.template head<3>().norm());
    orientation_error = std::max(orientation_error, sample.error.template tail<3>().norm());
    arm.kinematics(sample.q, kinematics);
    const double square = (kinematics.J * kinematics.J.transpose()).determinant();
    manipulability = std::min(manipulability, std::sqrt(std::max(square, 0.0)));
  });
  if (result.status != fpbm::Status::kOk) {
    std::printf("%s stopped at %g s: %s. %s\n", name, result.time, message(result.status), advice(result.status));
    return false;
  }
  std::printf("%-6s %6.3f %8.3f %8.4f   %.0e  %.0e %8.4f %8.4f\n", name, speed, acceleration, result.last.qd.norm(),
              error, orientation_error, manipulability, (result.last.q - start).norm());
  return true;
}

int main() {
  constexpr double kPi = fpbm::kTwoPi / 2.0;
  const Joints ready{0.0, -kPi / 4, 0.0, -3 * kPi / 4, 0.0, kPi / 2, kPi / 4};  // [rad], the hand points down
  const Joints weights{8, 8, 4, 4, 2, 1, 1};  // The diagonal of W: larger near the base, where joints carry more.
  const auto rest = fpbm::NullSpace<7>().with_damping(4.0).with_rest_posture(ready, 4.0);

  // The task determines six of the seven degrees of freedom, so all peaks are similar, and only the motion of the elbow
  // differs. With MVN and WMVN, the posture changes from circle to circle. With MAN, the elbow still moves when the tip
  // is at rest, and the tip error grows. With FPBM, the tip error decays, and the arm stops in its start
  // posture.
  std::puts("        peak    peak     final   tip error      least    from first");
  std::puts("        rad/s   rad/s²   rad/s   m      rad     manip.  posture, rad");
  const bool done = run("MVN", fpbm::MVN<7>(), ready) && run("WMVN", fpbm::WMVN<7>(weights), ready) &&
                    run("MAN", fpbm::MAN<7>(), ready) &&
                    run("FPBM", fpbm::FPBM<7>(0.6, weights, 20.0, 100.0, rest), ready);  // alpha, W, k1, k2, z
  return done ? 0 : 1;
}
