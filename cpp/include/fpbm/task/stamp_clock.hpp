#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Tells, tick by tick, how old the newest stamp is, on the clock that the stamps are of.
///
/// That clock is learnt: the first stamp is heard as it is made, and so is each that would be later than now. It runs
/// slow by 1e-4, so that it follows a clock that drifts by less. Leads of less than a tick are taken in smoothly. A
/// clock whose time at the first tick is known is not learnt.
template <typename Scalar>
class StampClock {
 public:
  /// ease: how long a small lead takes to be taken in, and how far a stamp may be ahead of a clock that is known [s].
  StampClock(Scalar dt, Scalar ease, std::optional<double> start) noexcept
      : dt_(dt),
        ease_(ease),
        share_(std::min(dt / ease, Scalar(1))),
        slow_(start ? Scalar(0) : Scalar(1e-4)),
        learns_(!start),
        newest_(start.value_or(0.0)) {}

  /// Seconds since the newest stamp.
  [[nodiscard]] Scalar age() const noexcept { return age_; }

  /// Seconds of the stamps' clock per second of the coming tick.
  [[nodiscard]] Scalar rate() const noexcept { return Scalar(1) - slow_ + share_ * lead_ / dt_; }

  /// Seconds from the newest stamp to this one, which is the newest from now on; none where it is not newer, not
  /// finite, or beyond the future of a clock that is known.
  [[nodiscard]] std::optional<Scalar> hear(double stamp) noexcept {
    if (!std::isfinite(stamp) || (known_ && !(stamp > newest_))) return {};
    const Scalar elapsed = learns_ && !known_ ? age_ : static_cast<Scalar>(stamp - newest_);
    if (!std::isfinite(elapsed) || (!learns_ && age_ - elapsed < -ease_)) return {};
    known_ = true;
    newest_ = stamp;
    age_ -= elapsed;
    if (!learns_) return elapsed;
    if (age_ < -dt_) {
      age_ = lead_ = Scalar(0);
    } else {
      lead_ = std::max(lead_, -age_);
    }
    return elapsed;
  }

  /// The same for a stamp of now.
  [[nodiscard]] Scalar hear_now() noexcept {
    const Scalar elapsed = std::max(age_, Scalar(0));
    newest_ += static_cast<double>(elapsed);
    age_ -= elapsed;
    return elapsed;
  }

  void advance() noexcept {
    age_ += rate() * dt_;
    lead_ -= share_ * lead_;
  }

  /// Learns anew, unless the clock is known.
  void forget() noexcept {
    if (!learns_) return;
    known_ = false;
    age_ = lead_ = Scalar(0);
  }

 private:
  Scalar dt_;
  Scalar ease_;
  Scalar share_;  ///< Of a lead, taken in by a tick.
  Scalar slow_;
  bool learns_;
  bool known_ = false;  ///< Whether a stamp was heard.
  double newest_;       ///< A float would not tell milliseconds apart after some hours.
  Scalar age_{0};
  Scalar lead_{0};  ///< By how much the clock is still behind the most punctual stamp.
};

}  // namespace fpbm
