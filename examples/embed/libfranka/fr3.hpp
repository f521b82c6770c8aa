#pragma once

#include <franka/robot_state.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fpbm/fpbm.hpp>
#include <fpbm/realtime/tracker.hpp>

/// Limits, scheme and path of a Franka Research 3, for both programs in this folder.
namespace fr3 {

using Joints = fpbm::Vector<7>;
using Limits = fpbm::Limits<fpbm::Level::kAcceleration, 7>;

inline constexpr double kMargin = 1e-3;  // Distance from every bound that libfranka's own limiter keeps.

inline fpbm::SerialArm<7> arm() {
  return fpbm::SerialArm<7>(fpbm::presets::fr3());
}

/// All limits that the robot checks in a motion. jerk: largest jerk [rad/s³].
inline Limits limits(double tick, double jerk = 5000.0) {
  fpbm::JointLimits<7> bounds = arm().limits();
  bounds.jerk.setConstant(jerk);
  for (Joints* row : {&bounds.velocity, &bounds.acceleration, &bounds.jerk}) row->array() -= kMargin;
  bounds.velocity_offset.array() += kMargin;
  return Limits(bounds, tick);
}

/// FPBM with a rest posture.
inline auto scheme(const Joints& posture) {
  return fpbm::FPBM<7>(0.6, Joints{8, 8, 4, 4, 2, 1, 1}, 20.0, 100.0,
                       fpbm::NullSpace<7>().with_damping(4.0).with_rest_posture(posture, 4.0));
}

/// A horizontal circle with a constant orientation of the hand, smooth at both ends, as the robot requires.
inline auto circle(double radius, double duration) {
  return fpbm::WithRotation(
      fpbm::InPlane(fpbm::Path(fpbm::Circle(radius), duration, fpbm::Quintic{}), {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}));
}

/// Inertia of the hand and the load that are configured in the robot, in the frame of the flange.
inline fpbm::LinkInertia<> load(const franka::RobotState& state) {
  return {state.m_total, Eigen::Map<const Eigen::Vector3d>(state.F_x_Ctotal.data()),
          Eigen::Map<const Eigen::Matrix3d>(state.I_total.data())};
}

inline Joints joints(const std::array<double, 7>& values) {
  return Eigen::Map<const Eigen::Matrix<double, 7, 1>>(values.data());
}

inline std::array<double, 7> array(const Joints& values) {
  std::array<double, 7> result;
  std::copy(values.data(), values.data() + 7, result.begin());
  return result;
}

inline volatile std::sig_atomic_t interrupted = 0;

/// After this call, Ctrl-C requests a stop and does not end the program.
inline void catch_interrupt() {
  std::signal(SIGINT, [](int) { interrupted = 1; });
}

}  // namespace fr3
