#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Age of the newest stamp, tick by tick, on the clock that the stamps are of.
///
/// The clock is learnt. The least delayed stamp of a window of 5 to 10 s counts as not delayed, so that a drift causes
/// an error of at most 10 s times the drift. Within the window the learnt clock runs slow by 1e-4: stamps of a clock
/// that drifts by less never lie ahead of it for long. Corrections of less than a tick forward, and all backward, are
/// made smoothly. A clock whose time at the first tick is known is not learnt.
///
/// A stamp is rejected if it is not newer than the newest, or too far ahead (follows()). If stamps are rejected for a
/// whole timeout, three at least, and follow each other, then the sender's clock was set: it is learnt anew. After a
/// silence of 10 s, any stamp is of a clock that was set.
template <typename Scalar>
class StampClock {
 public:
  /// timeout: time constant of the corrections; shortest run of rejected stamps; how far a stamp may be ahead of a
  /// known clock [s].
  StampClock(Scalar dt, Scalar timeout, std::optional<double> start) noexcept
      : dt_(dt),
        timeout_(timeout),
        share_(std::min(dt / timeout, Scalar(1))),
        slow_(start ? Scalar(0) : Scalar(1e-4)),
        learns_(!start),
        newest_(start.value_or(0.0)) {}

  /// Seconds since the newest stamp.
  [[nodiscard]] Scalar age() const noexcept { return age_; }

  /// Seconds of the stamps' clock per second of the coming tick.
  [[nodiscard]] Scalar rate() const noexcept { return Scalar(1) - slow_ - correction() / dt_; }

  /// Seconds from the newest stamp to this one, which is the newest from now on; none if it is rejected.
  [[nodiscard]] std::optional<Scalar> hear(double stamp) noexcept {
    if (!std::isfinite(stamp)) return {};
    if (!learns_) return hear_known(stamp);
    if (known_ && !follows(stamp - newest_, std::max(age_, Scalar(0))) && !set_anew(stamp)) return {};
    const Scalar elapsed = known_ ? static_cast<Scalar>(stamp - newest_) : age_;
    known_ = true;
    newest_ = stamp;
    age_ -= elapsed;
    rejected_ = 0;
    learn();
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
    const Scalar back = correction();
    age_ += rate() * dt_;
    shift(-back);
    rejected_for_ += dt_;
    half_ += dt_;
    if (half_ < kHalf) return;
    half_ = Scalar(0);
    least_before_ = least_;
    least_ = kNone;
  }

  /// Learns anew, unless the clock is known.
  void forget() noexcept {
    if (!learns_) return;
    known_ = false;
    age_ = Scalar(0);
    least_ = least_before_ = kNone;
    rejected_ = 0;
  }

 private:
  static constexpr Scalar kHalf{
      5};  ///< Half the window [s]: 150 stamps at 30 Hz, the least of 20 ms jitter is 0.13 ms.
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();
  static constexpr int kRun = 3;  ///< Fewest rejected stamps that stand for a clock that was set.

  /// Whether a stamp some seconds after another is plausible so long after it: newer, by twice the time and half a
  /// timeout at most. A simulation may run at twice the speed, and an earlier stamp may have been delayed.
  [[nodiscard]] bool follows(double elapsed, Scalar since) const noexcept {
    return elapsed > 0.0 && elapsed <= static_cast<double>(Scalar(2) * since + timeout_ / Scalar(2));
  }

  [[nodiscard]] std::optional<Scalar> hear_known(double stamp) noexcept {
    if (known_ && !(stamp > newest_)) return {};
    const auto elapsed = static_cast<Scalar>(stamp - newest_);
    if (!std::isfinite(elapsed) || age_ - elapsed < -timeout_) return {};
    known_ = true;
    newest_ = stamp;
    age_ -= elapsed;
    return elapsed;
  }

  /// Counts a stamp that does not fit; true if the run of them, or a silence before it, shows that the clock was set,
  /// which is then forgotten.
  [[nodiscard]] bool set_anew(double stamp) noexcept {
    if (rejected_ > 0 && stamp > last_rejected_ && follows(stamp - first_rejected_, rejected_for_)) {
      last_rejected_ = stamp;
      ++rejected_;
    } else {
      first_rejected_ = last_rejected_ = stamp;
      rejected_for_ = Scalar(0);
      rejected_ = 1;
    }
    if (age_ < Scalar(2) * kHalf && (rejected_ < kRun || rejected_for_ < timeout_)) return false;
    const Scalar since = age_;
    forget();
    age_ = since;
    return true;
  }

  /// Takes the newest stamp's delay, age_, into the window.
  void learn() noexcept {
    const bool first = std::min(least_, least_before_) == kNone;
    if (first || age_ < -dt_) {
      shift(-age_);
      age_ = Scalar(0);
    }
    least_ = std::min(least_, age_);
  }

  /// By how much the coming tick sets the clock back: a share of the least delay, half a tick at most [s].
  [[nodiscard]] Scalar correction() const noexcept {
    const Scalar least = std::min(least_, least_before_);
    return least == kNone ? Scalar(0) : std::min(share_ * least, dt_ / Scalar(2));
  }

  /// Delays are relative to the learnt clock.
  void shift(Scalar forward) noexcept {
    least_ += forward;
    least_before_ += forward;
  }

  Scalar dt_;
  Scalar timeout_;
  Scalar share_;  ///< Of a correction, made by a tick.
  Scalar slow_;
  bool learns_;
  bool known_ = false;  ///< Whether a stamp was heard.
  double newest_;       ///< A float would not tell milliseconds apart after some hours.
  Scalar age_{0};
  Scalar half_{0};               ///< Time in the half of the window that is filled [s].
  Scalar least_{kNone};          ///< Least delay in that half,
  Scalar least_before_{kNone};   ///< and in the half before.
  int rejected_ = 0;             ///< Stamps in the run of rejected ones,
  double first_rejected_ = 0.0;  ///< from here
  double last_rejected_ = 0.0;   ///< to here,
  Scalar rejected_for_{0};       ///< and how long ago it began [s].
};

}  // namespace fpbm
