#pragma once

#include <cstddef>
#include <fpbm/any/any_stack.hpp>
#include <fpbm/limits/limits.hpp>
#include <fpbm/model/tree.hpp>
#include <fpbm/objective/null_space.hpp>
#include <fpbm/realtime/tick.hpp>
#include <fpbm/target/target_filter.hpp>
#include <fpbm_controllers/joint_chunk.hpp>
#include <fpbm_controllers/motion_bounds.hpp>
#include <fpbm_controllers/report.hpp>
#include <fpbm_controllers/target.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fpbm_controllers {

/// The pose, the position or the z axis of a frame, in the base frame or relative to another frame.
struct MotionTask {
  std::string gains_of;  ///< Prefix of the names of the gains in messages.
  int level;             ///< Task level, counted from 0.
  fpbm::TaskGains<> gains;
  fpbm::LinkFrame<> frame;
  std::optional<fpbm::LinkFrame<>> reference;
  std::size_t target;  ///< Index of the target, a pose.
  fpbm::FrameCoordinates coordinates = fpbm::FrameCoordinates::kPose;
};

/// The null-space motion of a robot, and the balance of the scheme.
struct MotionScheme {
  using Joints = fpbm::Vector<Eigen::Dynamic>;

  double alpha;
  Joints weights;
  double null_damping;                 ///< [1/s]
  double rest_stiffness;               ///< [1/s²]
  std::optional<Joints> rest_posture;  ///< Default: given to begin() [rad].
};

/// The null-space motion. rest: the default rest posture.
[[nodiscard]] inline fpbm::NullSpace<Eigen::Dynamic> null_space_of(const MotionScheme& scheme,
                                                                   const MotionScheme::Joints& rest) {
  auto null_space = fpbm::NullSpace<Eigen::Dynamic>().with_damping(scheme.null_damping);
  if (scheme.rest_stiffness > 0.0) {
    null_space = null_space.with_rest_posture(scheme.rest_posture.value_or(rest), scheme.rest_stiffness);
  }
  return null_space;
}

struct MotionSettings {
  fpbm::Tree<> tree;
  std::vector<MotionTask> tasks;
  MotionScheme scheme;
  fpbm::TrackerOptions<> options;
  fpbm::Limits<fpbm::Level::kAcceleration, Eigen::Dynamic> limits;
  fpbm::TargetBounds<> target;   ///< Bounds on each task's reference.
  fpbm::StreamOptions<> filter;  ///< The delay and the blend are only for streams of joint positions.
  SharedBounds::View bounds;
  double keep_path;  ///< Tolerance of a KeptStream [rad].
};

/// The motion of a robot toward the targets of its tasks, each through a filter, or along a stream of joint positions.
///
/// Only make_motion() allocates.
class Motion {
 public:
  using Joints = MotionScheme::Joints;

  Motion() = default;
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;
  virtual ~Motion() = default;

  /// Starts at rest from a posture, which must keep the bounds. rest: the default rest posture. Throws
  /// std::invalid_argument if the posture is beyond a limit.
  virtual void begin(const Joints& q, const Joints& rest) = 0;
  /// Sets a new target of a task. Returns false if the target is rejected because of its stamp.
  virtual bool push(std::size_t, const Target&) noexcept { return false; }
  /// As push(), for joint positions.
  virtual bool push_chunk(JointChunk&) noexcept { return false; }
  /// Reduces the bounds of all filters on velocity to a fraction in (0, 1] (TargetFilter::set_speed).
  virtual void set_speed(double fraction) noexcept = 0;
  /// One tick: sets the status, and the scale and the errors of each task.
  virtual void tick(Report& report) noexcept = 0;
  /// Brings the robot to rest until begin().
  virtual void stop() noexcept = 0;

  /// Joint commands.
  [[nodiscard]] virtual const fpbm::State<Eigen::Dynamic>& state() const noexcept = 0;
  /// Acceleration of the last tick.
  [[nodiscard]] virtual const Joints& acceleration() const noexcept = 0;
  /// Sets the frame of each task in the commanded posture.
  virtual void locate(Report& report) const noexcept = 0;
};

/// Motion of one tip by a tracker of a pose, in less than half of the time of a stack. settings must have one task, a
/// pose without a reference frame. Throws std::invalid_argument if a gain is too high for the tick.
[[nodiscard]] std::unique_ptr<Motion> make_tip_motion(const MotionSettings& settings);

/// Motion of any tasks by a tracker of a stack. Throws std::invalid_argument if a gain is too high for the tick, or if
/// a task does not fit the robot.
[[nodiscard]] std::unique_ptr<Motion> make_stack_motion(const MotionSettings& settings);

/// Motion along a stream of joint positions, with the gains of the first task, whose frame is the tip. Throws
/// std::invalid_argument if a gain is too high for the tick.
[[nodiscard]] std::unique_ptr<Motion> make_joint_motion(const MotionSettings& settings);

/// Passes a target to the filter of a task. Returns false if the target is rejected because of its stamp.
template <typename Filter>
bool push_to(Filter& filter, const Target& target) noexcept {
  const auto push = [&](auto... stamp) noexcept {
    return target.moves ? filter.push_twist(target.twist, stamp...) : filter.push(target.pose, stamp...);
  };
  return target.stamp == 0.0 ? push() : push(target.stamp);
}

}  // namespace fpbm_controllers
