#pragma once

#include <chrono>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <rclcpp/parameter.hpp>
#include <rclcpp/time.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Stands in for rclcpp's header of this name: only the members that the controller uses. Only the test sends and
// receives messages, by Subscription::hear() and Publisher::last.
namespace rclcpp {

class Logger {};
class Clock {};

enum class ReliabilityPolicy { BestEffort, Reliable };

/// Reliable unless best_effort() is called, as with Cyclone DDS.
class QoS {
 public:
  explicit QoS(std::size_t depth) : depth_(depth) {}
  QoS& best_effort() {
    reliability_ = ReliabilityPolicy::BestEffort;
    return *this;
  }
  [[nodiscard]] std::size_t depth() const { return depth_; }
  [[nodiscard]] ReliabilityPolicy reliability() const { return reliability_; }

 private:
  std::size_t depth_;
  ReliabilityPolicy reliability_ = ReliabilityPolicy::Reliable;
};
class SystemDefaultsQoS : public QoS {
 public:
  SystemDefaultsQoS() : QoS(10) {}
};
class SensorDataQoS : public QoS {
 public:
  SensorDataQoS() : QoS(5) { best_effort(); }
};

template <typename Message>
class Subscription {
 public:
  Subscription(const QoS& qos, std::function<void(const Message&)> callback)
      : qos_(qos), callback_(std::move(callback)) {}
  /// Delivers a message from a publisher with the QoS `offered`. If the subscription is reliable and the publisher is
  /// not, the message is lost.
  void hear(const Message& message, const QoS& offered = SystemDefaultsQoS()) const {
    const bool wants_more =
        qos_.reliability() == ReliabilityPolicy::Reliable && offered.reliability() == ReliabilityPolicy::BestEffort;
    if (!wants_more) callback_(message);
  }
  [[nodiscard]] const QoS& qos() const { return qos_; }

 private:
  QoS qos_;
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
inline std::string log;  ///< All log messages, one per line.

[[gnu::format(printf, 2, 3)]] inline void write(const char* level, const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  char line[500];
  (void)std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  std::printf("     [%s] %s\n", level, line);
  log += line;
  log += '\n';
}

}  // namespace stand_in

#define RCLCPP_INFO(logger, ...) (static_cast<void>(logger), stand_in::write("info", __VA_ARGS__))
#define RCLCPP_WARN(logger, ...) \
  (static_cast<void>(logger), ++stand_in::warnings, stand_in::write("warning", __VA_ARGS__))
#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), stand_in::write("error", __VA_ARGS__))
#define RCLCPP_WARN_THROTTLE(logger, clock, milliseconds, ...) \
  (static_cast<void>(clock), static_cast<void>(milliseconds), RCLCPP_WARN(logger, __VA_ARGS__))
