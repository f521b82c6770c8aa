#pragma once

#include <fpbm_controllers/target_controller_parameters.hpp>
#include <string>
#include <vector>

namespace fpbm_controllers {

/// A task from the parameters: the pose of a link, in the base frame or relative to another link.
struct TaskSettings {
  std::string name;       ///< Empty: the only task, which has no name.
  std::string frame;      ///< Link that the task moves.
  std::string reference;  ///< Link in whose frame poses are given; empty: the base frame.
  int level = 0;          ///< From 0, the highest priority.
  double k1 = 0.0;        ///< [1/s]
  double k2 = 0.0;        ///< [1/s²]

  /// The parameter that names the frame of the task.
  [[nodiscard]] std::string frame_parameter() const { return name.empty() ? "tip_frame" : parameter("frame"); }
  [[nodiscard]] std::string parameter(const char* own) const { return "task." + name + "." + own; }
  [[nodiscard]] std::string topic(const char* own) const { return (name.empty() ? "~/" : "~/" + name + "/") + own; }
};

/// Throws std::invalid_argument, which names the parameter, unless there is either tip_frame or tasks, and each task
/// has a frame, a name for topics and a level with a free place.
[[nodiscard]] std::vector<TaskSettings> task_settings(const target_controller::Params& params);

}  // namespace fpbm_controllers
