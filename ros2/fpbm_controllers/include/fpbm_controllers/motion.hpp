#pragma once

#include <cstddef>
#include <fpbm/limits/limits.hpp>
#include <fpbm/model/tree.hpp>
#include <fpbm/realtime/tick.hpp>
#include <fpbm/task/link_frame.hpp>
#include <fpbm/task/target_bounds.hpp>
#include <fpbm/task/task_gains.hpp>
#include <fpbm_controllers/report.hpp>
#include <fpbm_controllers/target.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fpbm_controllers {

/// The pose of a frame, in the base frame or relative to another frame.
struct MotionTask {
  std::string gains_of;  ///< What messages put before the names of the gains.
  int level;             ///< From 0.
  fpbm::TaskGains<> gains;
  fpbm::LinkFrame<> frame;
  std::optional<fpbm::LinkFrame<>> reference;
};

/// The null-space motion of a robot, and the balance of the scheme.
struct MotionScheme {
  using Joints = fpbm::Vector<Eigen::Dynamic>;

  double alpha;
  Joints weights;
  double null_damping;                 ///< [1/s]
  double rest_stiffness;               ///< [1/s²]
  std::optional<Joints> rest_posture;  ///< None: the posture of begin() [rad].
};

struct MotionSettings {
  fpbm::Tree<> tree;
  std::vector<MotionTask> tasks;
  MotionScheme scheme;
  fpbm::TrackerOptions<> options;
  fpbm::Limits<fpbm::Level::kAcceleration, Eigen::Dynamic> limits;
  fpbm::TargetBounds<> bounds;  ///< Of each task's reference.
  fpbm::TargetFilterOptions<> filter;
};

/// The motion of a robot toward the targets of its tasks: a tracker of a stack, and a filter of each task's targets.
///
/// Only the constructor allocates.
class Motion {
 public:
  using Joints = MotionScheme::Joints;

  /// Throws std::invalid_argument where a gain is too high for the tick, or a task does not suit the robot.
  explicit Motion(const MotionSettings& settings);
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;
  ~Motion();

  /// Starts at rest from a posture. Throws std::invalid_argument where the posture is beyond a limit.
  void begin(const Joints& q);
  /// A new target of a task. False where its stamp rejects it.
  bool push(std::size_t task, const Target& target) noexcept;
  /// One tick: sets the status, and the scale and the errors of each task.
  void tick(Report& report) noexcept;
  /// Brings the robot to rest until begin().
  void stop() noexcept;

  /// The commands.
  [[nodiscard]] const fpbm::State<Eigen::Dynamic>& state() const noexcept;
  /// Sets where each task is in the commanded posture.
  void locate(Report& report) const noexcept;

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace fpbm_controllers
