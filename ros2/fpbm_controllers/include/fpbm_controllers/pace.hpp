#pragma once

#include <algorithm>

namespace fpbm_controllers {

/// Decides which calls of a loop are ticks of a fixed length. A call is not a tick if the previous ticks are ahead of
/// the clock of the loop by one tick or more. If calls are late, the ticks do not catch up.
class Pace {
 public:
  /// dt: length of a tick [s].
  explicit Pace(double dt = 1.0) noexcept : dt_(dt) {}

  /// Whether a call is a tick. period: time since the last call [s].
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
