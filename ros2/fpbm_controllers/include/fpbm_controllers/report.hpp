#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <fpbm/core/status.hpp>
#include <fpbm/core/types.hpp>
#include <fpbm/geometry/rotation.hpp>
#include <fpbm_controllers/nearest_pair.hpp>
#include <optional>
#include <rclcpp/time.hpp>
#include <string>
#include <vector>

namespace fpbm_controllers {

/// Why an arm was stopped until it is activated again.
enum class Fault : std::uint8_t { kNone, kFollowing, kUnreadable, kLocked };

/// Result of a tick for a task.
struct TaskReport {
  double scale = 1.0;              ///< Task scale.
  double position_error = 0.0;     ///< Position error relative to the filter's reference [m].
  double orientation_error = 0.0;  ///< Orientation error, or the largest error of a joint [rad].
  std::uint64_t rejected = 0;      ///< Targets rejected because of their stamps.
  bool ahead = false;    ///< Whether the last rejected stamp was too far ahead, and not older than earlier stamps.
  fpbm::Transform<> at;  ///< Frame of the task, in the base frame or the reference frame.
};

/// Result of a tick: numbers only, so that the loop allocates no memory for reports.
struct Report {
  static constexpr std::size_t kTasks = 8;  ///< Largest number of tasks.

  bool active = false;  ///< Whether there was a tick since the controller was activated.
  Fault fault = Fault::kNone;
  std::size_t fault_joint = 0;
  fpbm::Status status = fpbm::Status::kOk;
  double speed = 1.0;            ///< Fraction of the bounds on the velocity of the targets.
  double following_error = 0.0;  ///< Largest of all joints; after a fault, the value at the fault [rad].
  std::uint64_t missed = 0;      ///< Ticks in which another thread had locked an interface.
  std::uint64_t early = 0;       ///< Calls that came too soon to be ticks.
  std::uint64_t limited = 0;     ///< Ticks in which a torque was limited to its bound.
  std::size_t limited_joint = 0;
  std::optional<double> age;  ///< Time since the newest stamp of joint positions [s]; none with target poses.
  rclcpp::Time time = rclcpp::Time();
  std::array<TaskReport, kTasks> tasks;
  fpbm::Vector<Eigen::Dynamic> q;  ///< Commanded posture. No memory is allocated for robots of fpbm.
};

/// Description of a fault, with advice.
[[nodiscard]] inline std::string message_of(const Report& report, const std::vector<std::string>& joints) {
  const std::string joint = "joint '" + joints.at(report.fault_joint) + "': ";
  const std::string advice = ": the arm stops. Deactivate the controller, then activate it.";
  switch (report.fault) {
    case Fault::kNone: break;
    case Fault::kFollowing:
      return joint + std::to_string(report.following_error) + " rad from its command, beyond following_error" + advice;
    case Fault::kUnreadable: return joint + "its position or velocity is not a number" + advice;
    case Fault::kLocked: return joint + "its command interface stays locked by another thread" + advice;
  }
  return "";
}

/// Description of a torque at its bound.
[[nodiscard]] inline std::string limited_message(const Report& report, const std::vector<std::string>& joints) {
  return "joint '" + joints.at(report.limited_joint) +
         "': its torque is limited to its effort, so that the arm follows its command less closely. Reduce the "
         "payload, "
         "the bounds on acceleration or the gains.";
}

/// fpbm::advice() for users of ROS.
[[nodiscard]] inline const char* advice_of(fpbm::Status status) {
  switch (status) {
    case fpbm::Status::kCoarse: return "Raise update_rate.";
    case fpbm::Status::kSlowed:
      return "Expect a tip error until the joints leave their limits, or send slower targets. The scales of the tasks "
             "show which task is limited.";
    case fpbm::Status::kStalled: return "Move the target into the workspace, or send another target.";
    case fpbm::Status::kNotFinite: return "Lower the gains, or raise update_rate.";
    default: return fpbm::advice(status);
  }
}

/// Why the last targets of a task were rejected.
[[nodiscard]] inline std::string rejected_message(const TaskReport& task) {
  return std::string(task.ahead ? "too far ahead of" : "not newer than") + " earlier stamps. Check the sender's clock.";
}

/// A count with its noun.
[[nodiscard]] inline std::string counted(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Suffix of messages with the name of a task; empty for a single task, which has no name.
[[nodiscard]] inline std::string of_task(const std::string& name) {
  return name.empty() ? "" : " of task '" + name + "'";
}

/// A report as a message. before: the report of the previous message. tasks: names of the tasks. nearest: None without
/// a clearance.
[[nodiscard]] inline diagnostic_msgs::msg::DiagnosticStatus diagnostic_of(const Report& report, const Report& before,
                                                                          const std::vector<std::string>& joints,
                                                                          const std::vector<std::string>& tasks,
                                                                          const std::optional<NearestPair>& nearest) {
  using Message = diagnostic_msgs::msg::DiagnosticStatus;
  Message message;
  if (report.fault != Fault::kNone) {
    message.level = Message::ERROR;
    message.message = message_of(report, joints);
  } else {
    const bool well = report.status == fpbm::Status::kOk;
    message.level = well ? Message::OK : fpbm::failed(report.status) ? Message::ERROR : Message::WARN;
    message.message = std::string(fpbm::message(report.status)) + (well ? "" : ". ") + advice_of(report.status);
    if (well && report.missed > before.missed) {
      message.level = Message::WARN;
      message.message = "interfaces are locked by another thread: the arm waits";
    }
    if (well && report.limited > before.limited) {
      message.level = Message::WARN;
      message.message = limited_message(report, joints);
    }
    for (std::size_t k = tasks.size(); well && k-- > 0;) {
      if (report.tasks[k].rejected <= before.tasks[k].rejected) continue;
      message.level = Message::WARN;
      message.message =
          "targets" + of_task(tasks[k]) + " are rejected: the last stamp is " + rejected_message(report.tasks[k]);
    }
    if (message.level != Message::ERROR && nearest && nearest->is_too_close()) {
      message.level = Message::WARN;
      message.message = nearest->too_close() + "the arm only moves away. Remove the obstacle.";
    }
  }
  const auto add = [&message](const std::string& key, const std::string& value) {
    message.values.emplace_back();
    message.values.back().key = key;
    message.values.back().value = value;
  };
  const auto for_each_task = [&](auto&& add_values) {
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      add_values(tasks[k].empty() ? "" : tasks[k] + ": ", report.tasks[k]);
    }
  };
  for_each_task([&](const std::string& task, const TaskReport& values) {
    add(task + "scale", std::to_string(values.scale));
    if (report.age) {
      add("joint error [rad]", std::to_string(values.orientation_error));
      return;
    }
    add(task + "tip position error [m]", std::to_string(values.position_error));
    add(task + "tip orientation error [rad]", std::to_string(values.orientation_error));
  });
  add("following error [rad]", std::to_string(report.following_error));
  for_each_task([&](const std::string& task, const TaskReport& values) {
    add(task + "targets rejected", std::to_string(values.rejected));
  });
  add("ticks with a locked interface", std::to_string(report.missed));
  add("calls that came too soon", std::to_string(report.early));
  add("speed", std::to_string(report.speed));
  add("ticks with a limited torque", std::to_string(report.limited));
  if (report.age) add("age of the newest stamp [s]", std::to_string(*report.age));
  if (nearest) {
    add("nearest pair", nearest->names);
    add("distance of the nearest pair [m]", std::to_string(nearest->distance));
  }
  return message;
}

}  // namespace fpbm_controllers
