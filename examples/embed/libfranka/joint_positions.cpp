// A Franka Research 3 draws a circle with its hand held level, led by joint positions: Tracker::tick() in libfranka's
// callback.
//   joint_positions ROBOT_ADDRESS                                     Ctrl-C brings the arm to rest and ends.
// Compiled and run against a stand-in of libfranka only, never on a robot: begin slowly, the stop button at hand.

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
    const fpbm::TrackerOptions<> options;  // A tick of 1 ms, which is the robot's.
    const fpbm::State<7> at_rest{start, fr3::Joints::Zero()};
    fpbm::Tracker tracker(fr3::arm(), fpbm::Pose{}, fr3::scheme(start), at_rest, options, fr3::limits(options.dt));
    fpbm::PathFollower course(fr3::circle(0.1, 5.0), tracker.tip());  // radius [m], duration [s]
    fpbm::Status gravest = fpbm::Status::kOk;
    bool stopping = false;
    fr3::heed_interrupt();

    const auto callback = [&](const franka::RobotState&, franka::Duration period) -> franka::JointPositions {
      // The state that comes in is left alone: the tracker goes on from its own command, which the robot follows.
      // No tick on the first call; several where packets were lost, since the robot has gone on meanwhile.
      for (auto milliseconds = period.toMSec(); milliseconds > 0; --milliseconds) {
        gravest = worse(gravest, tracker.tick(course).status);
      }
      const double speed = tracker.state().qd.cwiseAbs().maxCoeff();
      if (fr3::interrupted || failed(gravest) || (course.done() && speed < 1e-3)) {
        tracker.stop();
        stopping = true;
      }
      const franka::JointPositions command(fr3::array(tracker.state().q));
      return stopping && speed < 1e-9 ? franka::MotionFinished(command) : command;
    };

    // The tracker bounds accelerations, not their jumps, which the robot refuses above 5000 rad/s³: stop() and a joint
    // that meets a bound make such. libfranka's limiter of rates takes them off.
    constexpr bool kLimitRate = true;
    robot.control(callback, franka::ControllerMode::kJointImpedance, kLimitRate);
    std::printf("at worst: %s\n", message(gravest));
    return failed(gravest) ? 1 : 0;
  } catch (const std::exception& error) {  // Of libfranka, or a start posture outside the limits.
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
