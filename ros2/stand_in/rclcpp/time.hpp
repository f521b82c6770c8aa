#pragma once

#include <cstdint>

// Stands in for rclcpp's headers time.hpp and duration.hpp, and for builtin_interfaces/Time.
namespace builtin_interfaces::msg {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};

}  // namespace builtin_interfaces::msg

namespace rclcpp {

class Time {
 public:
  explicit Time(std::int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
  operator builtin_interfaces::msg::Time() const {
    constexpr std::int64_t kSecond = 1000000000;
    return {static_cast<std::int32_t>(nanoseconds_ / kSecond), static_cast<std::uint32_t>(nanoseconds_ % kSecond)};
  }

 private:
  std::int64_t nanoseconds_;
};

class Duration {
 public:
  Duration(std::int32_t seconds, std::uint32_t nanoseconds) : seconds_(seconds + 1e-9 * nanoseconds) {}
  [[nodiscard]] static Duration from_seconds(double seconds) {
    Duration result(0, 0);
    result.seconds_ = seconds;
    return result;
  }
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  double seconds_;
};

}  // namespace rclcpp
