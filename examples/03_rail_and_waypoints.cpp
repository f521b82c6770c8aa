// An iiwa 14 on a rail moves along a bench beyond its workspace: the weights determine how far the rail moves.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fpbm/fpbm.hpp>

using Joints = fpbm::Vector<8>;

/// The preset arm on a prismatic joint along y.
fpbm::Chain<> iiwa_on_rail() {
  fpbm::Joint<> rail;
  rail.type = fpbm::JointType::kPrismatic;
  rail.axis = {0.0, 1.0, 0.0};
  rail.bounds.lower = -1.0;  // [m]
  rail.bounds.upper = 1.0;
  rail.bounds.velocity = 1.0;  // [m/s]
  rail.name = "rail";
  fpbm::Chain<> chain = fpbm::presets::iiwa14();
  chain.joints.insert(chain.joints.begin(), rail);
  return chain;
}

/// Moves the arm along the whole bench and prints the displacement of the rail. Returns false if the motion stops
/// early. 1 m/s of the rail costs as much as √weight rad/s of a joint.
bool run(const char* name, double weight) {
  const fpbm::SerialArm<8> arm(iiwa_on_rail());
  constexpr double kPi = fpbm::kTwoPi / 2.0;
  const Joints start{-0.8, -0.3, 0.6, 0.0, -1.5, 0.0, kPi - 2.1, 0.0};  // [m], [rad]: the hand points down

  // The first pose, displaced by x, y, z [m] and rotated about the vertical axis by an angle [rad].
  fpbm::Kinematics<fpbm::Pose, 8> first;
  arm.kinematics(start, first);
  const auto hand = [&](double x, double y, double z, double angle) {
    return fpbm::Pose::displace(first.tip, fpbm::Vector<6>{x, y, z, 0.0, 0.0, angle});
  };
  fpbm::TipBounds<> bounds;
  bounds.velocity = 0.5;          // [m/s]
  bounds.acceleration = 1.0;      // [m/s²]
  bounds.angular_velocity = 1.0;  // [rad/s]
  const auto path =
      fpbm::Waypoints<fpbm::Pose>::within({hand(0, 0, 0, 0), hand(0.05, 0.45, -0.15, 0.3), hand(0, 0.9, 0, 0),
                                           hand(0.05, 1.35, -0.15, -0.3), hand(0, 1.8, 0, 0)},
                                          bounds);

  const Joints weights{weight, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  const auto damping = fpbm::NullSpace<8>().with_damping(2.0);
  const auto scheme = fpbm::FPBM<8>(0.6, weights, 20.0, 100.0, damping);  // alpha, W, k1, k2, z
  const fpbm::TimeGrid grid(path.duration(), 1e-3, 1.0);

  double rail_speed = 0.0, joint_speed = 0.0, error = 0.0, orientation_error = 0.0;
  const auto result = fpbm::rollout(arm, path, scheme, {start, Joints::Zero()}, grid, [&](const auto& sample) noexcept {
    rail_speed = std::max(rail_speed, std::abs(sample.qd(0)));
    joint_speed = std::max(joint_speed, sample.qd.template tail<7>().cwiseAbs().maxCoeff());
    error = std::max(error, sample.error.template head<3>().norm());
    orientation_error = std::max(orientation_error, sample.error.template tail<3>().norm());
  });
  if (result.status != fpbm::Status::kOk) {
    std::printf("%s stopped at %g s: %s. %s\n", name, result.time, message(result.status), advice(result.status));
    return false;
  }
  std::printf("%s: rail from %.2f to %.2f m, at most %.2f m/s and %.2f rad/s, tip errors %.0e m and %.0e rad\n", name,
              start(0), result.last.q(0), rail_speed, joint_speed, error, orientation_error);
  return true;
}

int main() {
  // With a small entry in W, the rail follows the hand. With a large entry, the rail moves only as far as the workspace
  // requires.
  return run("light rail", 0.1) && run("heavy rail", 10.0) ? 0 : 1;
}
