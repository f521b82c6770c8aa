#pragma once

#include <cstdint>
#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <fpbm/core/rotation.hpp>
#include <fpbm/core/status.hpp>
#include <rclcpp/time.hpp>
#include <string>

namespace fpbm_controllers {

/// How a tick went: numbers only, so that the loop allocates nothing for it.
struct Report {
  bool active = false;  ///< Whether there was a tick since the controller was activated.
  bool lost = false;    ///< Whether the following error was too large, and the arm stops for it.
  fpbm::Status status = fpbm::Status::kOk;
  double scale = 1.0;              ///< Share of the task that the limits left.
  double position_error = 0.0;     ///< Of the tip, on the filter's reference [m],
  double orientation_error = 0.0;  ///< and [rad].
  double following_error = 0.0;    ///< The largest joint's [rad].
  std::uint64_t refused = 0;       ///< Targets whose stamps were not newer than those before.
  std::uint64_t missed = 0;        ///< Ticks in which another thread had locked an interface.
  rclcpp::Time time = rclcpp::Time();
  fpbm::Transform<> tip;
};

/// The same as a message.
[[nodiscard]] inline diagnostic_msgs::msg::DiagnosticStatus diagnostic_of(const Report& report) {
  using Message = diagnostic_msgs::msg::DiagnosticStatus;
  Message message;
  if (report.lost) {
    message.level = Message::ERROR;
    message.message = "the arm does not follow its commands: it stops. Deactivate the controller, then activate it.";
  } else {
    const bool well = report.status == fpbm::Status::kOk;
    message.level = well ? Message::OK : fpbm::failed(report.status) ? Message::ERROR : Message::WARN;
    message.message = std::string(fpbm::message(report.status)) + (well ? "" : ". ") + fpbm::advice(report.status);
  }
  const auto add = [&message](const char* key, const std::string& value) {
    message.values.emplace_back();
    message.values.back().key = key;
    message.values.back().value = value;
  };
  add("scale", std::to_string(report.scale));
  add("tip position error [m]", std::to_string(report.position_error));
  add("tip orientation error [rad]", std::to_string(report.orientation_error));
  add("following error [rad]", std::to_string(report.following_error));
  add("targets refused", std::to_string(report.refused));
  add("ticks with a locked interface", std::to_string(report.missed));
  return message;
}

}  // namespace fpbm_controllers
