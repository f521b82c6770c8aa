// A Franka Research 3 draws a circle with a constant orientation of the hand, by torques: Tracker::resolve_measured()
// computes the acceleration for the measured state, and the robot's own model the torques for this acceleration.
//   torques ROBOT_ADDRESS                                             Ctrl-C stops the arm and the program.
// This program has run with a stand-in of libfranka only, never on a robot: start slowly, with the stop button at hand.

#include <franka/exception.h>
#include <franka/model.h>
#include <franka/robot.h>

#include <cstdio>

#include "fr3.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s ROBOT_ADDRESS\n", argv[0]);
    return 2;
  }
  try {
    franka::Robot robot(argv[1]);
    const franka::Model model = robot.loadModel();
    const fr3::Joints start = fr3::joints(robot.readOnce().q);
    const fpbm::TrackerOptions<> options;
    const fpbm::State<7> at_rest{start, fr3::Joints::Zero()};
    fpbm::Tracker tracker(fr3::arm(), fpbm::Pose{}, fr3::scheme(start), at_rest, options, fr3::limits(options.dt));
    fpbm::PathFollower follower(fr3::circle(0.1, 5.0), tracker.tip());  // radius [m], duration [s]
    fpbm::Status worst = fpbm::Status::kOk;
    bool stopping = false;
    fr3::catch_interrupt();

    const auto callback = [&](const franka::RobotState& state, franka::Duration period) -> franka::Torques {
      const fr3::Joints qd = fr3::joints(state.dq);
      if (!stopping) follower.advance(period.toSec());
      const auto tick = tracker.resolve_measured(fr3::joints(state.q), qd, follower.ahead(0.0));
      worst = worse(worst, tick.status);

      // M(q) qdd + c(q, qd). The robot adds gravity and friction.
      const std::array<double, 49> mass = model.mass(state);  // Column-major.
      const Eigen::Map<const Eigen::Matrix<double, 7, 7>> M(mass.data());
      const fr3::Joints torque = M * tick.qdd + fr3::joints(model.coriolis(state));

      const double speed = qd.cwiseAbs().maxCoeff();
      if (fr3::interrupted || failed(worst) || (follower.done() && speed < 0.02)) {
        tracker.stop();
        stopping = true;
      }
      const franka::Torques command(fr3::array(torque));
      return stopping && speed < 0.02 ? franka::MotionFinished(command) : command;  // The robot holds its position.
    };

    constexpr bool kLimitRate = true;  // The robot rejects torques that jump by more than 1 Nm in a tick.
    robot.control(callback, kLimitRate);
    std::printf("at worst: %s\n", message(worst));
    return failed(worst) ? 1 : 0;
  } catch (const std::exception& error) {  // From libfranka, or if the start posture is outside the limits.
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
