#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <rclcpp/time.hpp>
#include <string>
#include <utility>

// Stands in for rclcpp's header of this name: only what the controller uses. Messages go nowhere but to the test.
namespace rclcpp {

class Duration {
 public:
  Duration(std::int32_t, std::uint32_t) {}
};
class Logger {};
class Clock {};
class QoS {};
class SystemDefaultsQoS : public QoS {};

template <typename Message>
class Subscription {
 public:
  explicit Subscription(std::function<void(const Message&)> callback) : callback_(std::move(callback)) {}
  void hear(const Message& message) const { callback_(message); }

 private:
  std::function<void(const Message&)> callback_;
};

template <typename Message>
class Publisher {
 public:
  void publish(const Message& message) {
    last = message;
    ++count;
  }

  Message last;
  int count = 0;
};

class TimerBase {
 public:
  explicit TimerBase(std::function<void()> callback) : callback_(std::move(callback)) {}
  void fire() const { callback_(); }

 private:
  std::function<void()> callback_;
};

}  // namespace rclcpp

namespace stand_in {

inline int warnings = 0;

}  // namespace stand_in

#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), std::printf(__VA_ARGS__), std::printf("\n"))
#define RCLCPP_WARN_THROTTLE(logger, clock, milliseconds, ...) \
  (static_cast<void>(clock), static_cast<void>(milliseconds), ++stand_in::warnings, RCLCPP_ERROR(logger, __VA_ARGS__))
