#pragma once

#include <algorithm>

namespace fpbm_controllers {

/// Which calls of a loop are ticks: all, unless they come so soon that the ticks would be ahead of the loop's clock by
/// more than one. Ticks of a fixed length are then late where calls are late, and never fast.
class Pace {
 public:
  /// dt: length of a tick [s].
  explicit Pace(double dt = 1.0) noexcept : dt_(dt) {}

  /// Whether a call some seconds after the last is a tick.
  [[nodiscard]] bool due(double period) noexcept {
    ahead_ = std::max(ahead_ - period, 0.0);
    if (!(ahead_ < dt_)) return false;
    ahead_ += dt_;
    return true;
  }

 private:
  double dt_;
  double ahead_ = 0.0;  ///< Time of the ticks ahead of the clock [s].
};

}  // namespace fpbm_controllers
