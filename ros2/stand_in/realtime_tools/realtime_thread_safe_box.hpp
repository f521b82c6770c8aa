#pragma once

#include <functional>
#include <mutex>
#include <optional>

// Stands in for realtime_tools' header of this name. The signatures equal realtime_tools 3.11 (Jazzy) and
// 5.2 (Rolling).
namespace realtime_tools {

template <typename T>
class RealtimeThreadSafeBox {
 public:
  explicit RealtimeThreadSafeBox(const T& init = T{}) : value_(init) {}

  bool try_set(const T& value) {
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    if (lock.owns_lock()) value_ = value;
    return lock.owns_lock();
  }
  bool try_set(const std::function<void(T&)>& change) {
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    if (lock.owns_lock()) change(value_);
    return lock.owns_lock();
  }
  [[nodiscard]] std::optional<T> try_get() const {
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    return lock.owns_lock() ? std::optional<T>(value_) : std::nullopt;
  }
  void set(const T& value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    value_ = value;
  }
  [[nodiscard]] T get() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return value_;
  }

 private:
  T value_;
  mutable std::mutex mutex_;
};

}  // namespace realtime_tools
