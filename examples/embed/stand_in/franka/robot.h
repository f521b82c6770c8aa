#pragma once

#include <franka/exception.h>
#include <franka/robot_state.h>

#include <functional>
#include <string>

// Stand-in for the header of libfranka with this name and control_types.h: a robot that follows positions exactly, and
// under torques decoupled joints with an inertia of 1 kg m² each.
namespace franka {

enum class ControllerMode { kJointImpedance, kCartesianImpedance };

struct Finishable {
  bool motion_finished = false;
};

struct JointPositions : Finishable {
  JointPositions(const std::array<double, 7>& positions) noexcept : q(positions) {}
  std::array<double, 7> q;
};

struct Torques : Finishable {
  Torques(const std::array<double, 7>& torques) noexcept : tau_J(torques) {}
  std::array<double, 7> tau_J;
};

template <typename Command>
Command MotionFinished(Command command) noexcept {
  command.motion_finished = true;
  return command;
}

class Robot {
 public:
  explicit Robot(const std::string&) {}

  RobotState readOnce() { return state_; }

  void control(std::function<JointPositions(const RobotState&, Duration)> callback, ControllerMode, bool) {
    run(callback, [](RobotState& state, const JointPositions& command) {
      for (std::size_t i = 0; i < 7; ++i) {
        state.dq[i] = (command.q[i] - state.q[i]) / kTick;
        state.q[i] = command.q[i];
      }
    });
  }

  void control(std::function<Torques(const RobotState&, Duration)> callback, bool) {
    run(callback, [](RobotState& state, const Torques& command) {
      for (std::size_t i = 0; i < 7; ++i) {
        state.q[i] += kTick * (state.dq[i] + kTick / 2.0 * command.tau_J[i]);
        state.dq[i] += kTick * command.tau_J[i];
      }
    });
  }

 private:
  static constexpr double kTick = 1e-3;

  template <typename Callback, typename Plant>
  void run(const Callback& callback, const Plant& plant) {
    for (int tick = 0; tick < 60000; ++tick) {
      const auto command = callback(state_, Duration(tick == 0 ? 0 : 1));
      plant(state_, command);
      if (command.motion_finished) return;
    }
    throw Exception("the motion has not ended within a minute");
  }

  RobotState state_;
};

}  // namespace franka
