#pragma once

#include <franka/robot_state.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fpbm/fpbm.hpp>
#include <fpbm/realtime/tracker.hpp>

/// What both programs here need to know of a Franka Research 3.
namespace fr3 {

using Joints = fpbm::Vector<7>;
using Limits = fpbm::Limits<fpbm::Level::kAcceleration, 7>;

/// One joint: its range and velocity from Franka's robots/fr3/joint_limits.yaml, and the bounds on velocity that depend
/// on position, ±(−offset + √(root |end − q|)), from computeUpperLimitsJointVelocity() and its counterpart in libfranka
/// 0.15, franka/rate_limiting.h.
struct Joint {
  double lower, upper, velocity;  // [rad], [rad/s]
  double lower_end, upper_end;    // [rad]
  double offset, root;            // [rad/s], [rad/s²]
};
inline constexpr std::array<Joint, 7> kJoints = {{{-2.7437, 2.7437, 2.62, -2.7501, 2.7501, 0.30, 12.0},
                                                  {-1.7837, 1.7837, 2.62, -1.7918, 1.7918, 0.20, 5.17},
                                                  {-2.9007, 2.9007, 2.62, -2.9065, 2.9065, 0.20, 7.0},
                                                  {-3.0421, -0.1518, 2.62, -3.0481, -0.1458, 0.30, 8.0},
                                                  {-2.8065, 2.8065, 5.26, -2.8101, 2.8101, 0.35, 34.0},
                                                  {0.5445, 4.5169, 4.18, 0.54092, 4.5205, 0.35, 11.0},
                                                  {-3.0159, 3.0159, 5.26, -3.0196, 3.0196, 0.35, 34.0}}};
inline constexpr double kAcceleration = 10.0;  // [rad/s²], of every joint
inline constexpr double kMargin = 1e-3;        // The distance that libfranka's own limiter keeps from every bound.

/// Franka's envelope, as far as the joint can brake along it: those of joints 5 and 7 ask for 17 rad/s² of joints that
/// have 10. An envelope that is zero at the same place with the same slope lies below Franka's everywhere.
inline fpbm::VelocityEnvelope<> followed(double end, double range, double offset, double root) {
  const double deceleration = std::min(root / 2.0, kAcceleration - kMargin);
  const double rest = std::min(end - (offset + kMargin) * (offset + kMargin) / root, range - kMargin);
  const double slower = (offset + kMargin) * deceleration / (root / 2.0);
  return {rest + slower * slower / (2.0 * deceleration), slower, deceleration};
}

/// Everything that the robot checks in a motion, except its jerk.
inline Limits limits(double tick) {
  fpbm::JointLimits<7> bounds;
  for (std::size_t i = 0; i < 7; ++i) {
    const Joint& joint = kJoints[i];
    bounds.set(static_cast<Eigen::Index>(i),
               {joint.lower, joint.upper, joint.velocity - kMargin, kAcceleration - kMargin});
  }
  Limits result(bounds, tick);
  for (std::size_t i = 0; i < 7; ++i) {
    const Joint& joint = kJoints[i];
    fpbm::VelocityEnvelope<> lower = followed(-joint.lower_end, -joint.lower, joint.offset, joint.root);
    lower.end = -lower.end;
    result.set_lower_envelope(static_cast<Eigen::Index>(i), lower);
    result.set_upper_envelope(static_cast<Eigen::Index>(i),
                              followed(joint.upper_end, joint.upper, joint.offset, joint.root));
  }
  return result;
}

/// Panda and its successor have the same links.
inline fpbm::SerialArm<7> arm() {
  return fpbm::SerialArm<7>(fpbm::presets::panda());
}

/// FPBM that holds the elbow near a posture.
inline auto scheme(const Joints& posture) {
  return fpbm::FPBM<7>(0.6, Joints{8, 8, 4, 4, 2, 1, 1}, 20.0, 100.0,
                       fpbm::NullSpace<7>().with_damping(4.0).with_rest_posture(posture, 4.0));
}

/// A horizontal circle with the hand's orientation held; smooth at both ends, as the robot requires.
inline auto circle(double radius, double duration) {
  return fpbm::WithRotation(
      fpbm::InPlane(fpbm::Path(fpbm::Circle(radius), duration, fpbm::Quintic{}), {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}));
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

/// From now on Ctrl-C asks for a stop and does not end the program.
inline void catch_interrupt() {
  std::signal(SIGINT, [](int) { interrupted = 1; });
}

}  // namespace fr3
