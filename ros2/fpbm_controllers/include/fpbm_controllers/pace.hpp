#pragma once

#include <algorithm>

namespace fpbm_controllers {

/// Places the calls of a loop in ticks of a fixed length. A call after the end of a tick starts the next tick. If calls
/// are late, the ticks do not catch up.
class Pace {
 public:
  /// dt: length of a tick [s].
  explicit Pace(double dt = 1.0) noexcept : dt_(dt) {}

  /// Whether a call starts a tick. period: time since the last call [s].
  [[nodiscard]] bool starts(double period) noexcept {
    constexpr double kRoundOff = 1e-9;
    left_ -= std::max(period, 0.0);
    const bool starts = left_ < -kRoundOff * dt_;
    left_ = std::max(left_ + (starts ? dt_ : 0.0), 0.0);
    return starts;
  }
  /// Time from the last call to the end of the tick [s].
  [[nodiscard]] double left() const noexcept { return left_; }

 private:
  double dt_;
  double left_ = 0.0;
};

}  // namespace fpbm_controllers
