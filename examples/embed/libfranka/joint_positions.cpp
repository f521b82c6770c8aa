// A Franka Research 3 draws a circle with a constant orientation of the hand, by joint positions: Tracker::tick() in
// the callback of libfranka.
//   joint_positions ROBOT_ADDRESS                                     Ctrl-C stops the arm and the program.
// This program has run with a stand-in of libfranka only, never on a robot: start slowly, with the stop button at hand.

#include <franka/exception.h>
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
    const fr3::Joints start = fr3::joints(robot.readOnce().q);
    const fpbm::TrackerOptions<> options;  // A tick of 1 ms, as the robot's cycle.
    const fpbm::State<7> at_rest{start, fr3::Joints::Zero()};
    fpbm::Tracker tracker(fr3::arm(), fpbm::Pose{}, fr3::scheme(start), at_rest, options, fr3::limits(options.dt));
    fpbm::PathFollower follower(fr3::circle(0.1, 5.0), tracker.tip());  // radius [m], duration [s]
    fpbm::Status worst = fpbm::Status::kOk;
    bool stopping = false;
    fr3::catch_interrupt();

    const auto callback = [&](const franka::RobotState&, franka::Duration period) -> franka::JointPositions {
      // The tracker continues from its own command, which the robot follows, and does not use the measured state. The
      // first call has no tick. A call after lost packets has several ticks, because the robot moved on.
      for (auto milliseconds = period.toMSec(); milliseconds > 0; --milliseconds) {
        worst = worse(worst, tracker.tick(follower).status);
      }
      const double speed = tracker.state().qd.cwiseAbs().maxCoeff();
      if (fr3::interrupted || failed(worst) || (follower.done() && speed < 1e-3)) {
        tracker.stop();
        stopping = true;
      }
      const franka::JointPositions command(fr3::array(tracker.state().q));
      return stopping && speed < 1e-9 ? franka::MotionFinished(command) : command;
    };

    // The robot rejects jerks above 5000 rad/s³. The tracker keeps this bound, also during stop(). libfranka's rate
    // limiter is an additional check.
    constexpr bool kLimitRate = true;
    robot.control(callback, franka::ControllerMode::kJointImpedance, kLimitRate);
    std::printf("at worst: %s\n", message(worst));
    return failed(worst) ? 1 : 0;
  } catch (const std::exception& error) {  // From libfranka, or if the start posture is outside the limits.
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
