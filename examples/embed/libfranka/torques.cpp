// A Franka Research 3 draws a circle with a constant orientation of the hand, by torques: the feed-forward torques of
// the tracker's motion by the library's model, and a stiffness and a damping of the joints.
//   torques ROBOT_ADDRESS                                             Ctrl-C stops the arm and the program.
// This program has run with a stand-in of libfranka only, never on a robot: start slowly, with the stop button at hand.

#include <franka/exception.h>
#include <franka/robot.h>

#include <cstdio>

#include "fr3.hpp"

namespace {

// Stiffness [Nm/rad] and damping [Nm s/rad] of libfranka's example joint_impedance_control.cpp.
const fr3::Joints kStiffness{600, 600, 600, 600, 250, 150, 50};
const fr3::Joints kDamping{50, 50, 50, 50, 30, 25, 15};
constexpr double kJerk = 250.0;    // [rad/s³]; with 5000, the torques of a tick may change by more than 1 Nm.
constexpr double kFraction = 0.9;  // Part of the efforts for the reference; the remaining part is for the feedback.

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s ROBOT_ADDRESS\n", argv[0]);
    return 2;
  }
  try {
    franka::Robot robot(argv[1]);
    const franka::RobotState initial = robot.readOnce();
    const fr3::Joints start = fr3::joints(initial.q);
    const fpbm::Chain<> chain = fpbm::presets::fr3();
    fpbm::Dynamics<7> dynamics(chain);
    if (!dynamics.set_payload(fpbm::Robot<7>::kTip, fr3::load(initial))) {
      throw franka::Exception("the inertia of the load is not physical: correct the load in Desk");
    }
    const fpbm::Bounds bounds(fpbm::TorqueBounds<7>(chain, dynamics, kFraction * fr3::arm().limits().effort));
    const fpbm::TrackerOptions<> options;  // A tick of 1 ms, as the robot's cycle.
    const fr3::Joints zero = fr3::Joints::Zero();
    const fpbm::State<7> at_rest{start, zero};
    fpbm::Tracker tracker(fr3::arm(), fpbm::Pose{}, fr3::scheme(start), at_rest, options,
                          fr3::limits(options.dt, kJerk), zero, bounds);
    fpbm::PathFollower follower(fr3::circle(0.1, 5.0), tracker.tip());  // radius [m], duration [s]
    fpbm::Dynamics<7>::State state;
    fr3::Joints feed_forward = zero;
    fpbm::Status worst = fpbm::Status::kOk;
    bool stopping = false;
    fr3::catch_interrupt();

    const auto callback = [&](const franka::RobotState& measured, franka::Duration period) -> franka::Torques {
      for (auto milliseconds = period.toMSec(); milliseconds > 0; --milliseconds) {
        dynamics.robot().update(tracker.state().q, tracker.state().qd, state);
        const auto tick = tracker.tick(follower);
        worst = worse(worst, tick.status);
        // The robot adds gravity, and compensates friction.
        feed_forward = dynamics.inverse_dynamics(state, tick.qdd) - dynamics.gravity_torque(state);
      }
      const auto& [q, qd] = tracker.state();
      const fr3::Joints torque = feed_forward + kStiffness.cwiseProduct(q - fr3::joints(measured.q)) +
                                 kDamping.cwiseProduct(qd - fr3::joints(measured.dq));

      const double speed = qd.cwiseAbs().maxCoeff();
      if (fr3::interrupted || failed(worst) || (follower.done() && speed < 1e-3)) {
        tracker.stop();
        stopping = true;
      }
      const franka::Torques command(fr3::array(torque));
      return stopping && speed < 1e-9 ? franka::MotionFinished(command) : command;  // The robot holds its position.
    };

    constexpr bool kLimitRate = true;  // The robot rejects torques that change by more than 1 Nm in a tick.
    robot.control(callback, kLimitRate);
    std::printf("at worst: %s\n", message(worst));
    return failed(worst) ? 1 : 0;
  } catch (const std::exception& error) {  // From libfranka, or if the start posture is outside the limits.
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
