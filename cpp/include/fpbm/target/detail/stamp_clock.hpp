#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Age of the newest stamp at each tick, on the clock of the stamps.
///
/// The clock of the stamps is estimated. The stamp with the smallest delay in a window of 5 to 10 s counts as not
/// delayed, so that a drift of the clock causes an error of at most 10 s times the drift. Within the window, the
/// estimated clock is slow by 1e-4, so that the estimate follows a clock with a smaller drift. Forward corrections of
/// less than a tick, and all backward corrections, are smooth. A clock whose time at the first tick is known is not
/// estimated.
///
/// A stamp is rejected if it is not newer than the newest stamp, or too far ahead (follows()). If at least three stamps
/// that follow each other are rejected over a time of at least a timeout, the clock of the sender counts as reset. The
/// estimate then starts again. After a silence of 10 s, any stamp that does not follow the newest stamp counts as a
/// stamp of a reset clock.
template <typename Scalar>
class StampClock {
 public:
  /// timeout [s]: time constant of the corrections, shortest duration of rejected stamps for a reset, and largest time
  /// by which a stamp may be ahead of a known clock.
  StampClock(Scalar dt, Scalar timeout, std::optional<double> start) noexcept
      : dt_(dt),
        timeout_(timeout),
        fraction_(std::min(dt / timeout, Scalar(1))),
        slow_(start ? Scalar(0) : kSlow),
        learns_(!start),
        newest_(start.value_or(0.0)) {}

  /// Time since the newest stamp [s].
  [[nodiscard]] Scalar age() const noexcept { return age_; }

  /// Rate of the clock of the stamps in the coming tick [s/s].
  [[nodiscard]] Scalar rate() const noexcept { return Scalar(1) - slow_ - correction() / dt_; }

  /// Processes a stamp. If the stamp is rejected, returns no value. Otherwise, returns the time since the newest stamp
  /// [s], and the accepted stamp becomes the newest stamp.
  [[nodiscard]] std::optional<Scalar> accept(double stamp) noexcept {
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

  /// accept() for a stamp with the current time.
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

  /// Starts the estimate again, unless the clock is known.
  void reset() noexcept {
    if (!learns_) return;
    known_ = false;
    age_ = Scalar(0);
    least_ = least_before_ = kNone;
    rejected_ = 0;
  }

 private:
  // The ranges below pass TargetStream*, if all other constants are unchanged.

  /// Half the window [s]. Of 150 stamps at 30 Hz with 20 ms jitter, the smallest delay is 0.13 ms. 4 to 5 s pass; with
  /// 2.5 s, old_messages_stay_rejected fails, and with 7 s, follows_a_clock_that_drifts.
  static constexpr Scalar kHalf{5};
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();
  /// Smallest number of rejected stamps for a reset. 1 to 9 pass; 12 fails.
  static constexpr int kRun = 3;
  /// Rate by which an estimated clock is slow: the largest drift of usual quartz clocks. 0 to 2e-4 pass; 5e-4 fails.
  static constexpr Scalar kSlow = Scalar(1e-4);

  /// Whether a stamp follows an earlier stamp of `since` [s] ago. The stamp is newer by `elapsed` [s], which must be
  /// positive and at most twice `since` plus half a timeout. A simulation may run at twice real time, and the earlier
  /// stamp may have been delayed. Factors of 1 to 8, and times from half a timeout to a timeout, pass TargetStream*.
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

  /// Counts a stamp that does not follow the newest stamp. If the run of rejected stamps, or the silence before the
  /// stamp, shows that the clock was reset, starts the estimate again and returns true.
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
    reset();
    age_ = since;
    return true;
  }

  /// Adds the delay of the newest stamp, age_, to the window.
  void learn() noexcept {
    const bool first = std::min(least_, least_before_) == kNone;
    if (first || age_ < -dt_) {
      shift(-age_);
      age_ = Scalar(0);
    }
    least_ = std::min(least_, age_);
  }

  /// Backward correction of the clock in the coming tick [s]: a fraction of the smallest delay, at most half a tick, so
  /// that the clock has at least half of its rate. Limits of 0.1 to 5 ticks pass TargetStream*.
  [[nodiscard]] Scalar correction() const noexcept {
    const Scalar least = std::min(least_, least_before_);
    return least == kNone ? Scalar(0) : std::min(fraction_ * least, dt_ / Scalar(2));
  }

  /// Shifts the stored delays, which are relative to the estimated clock.
  void shift(Scalar forward) noexcept {
    least_ += forward;
    least_before_ += forward;
  }

  Scalar dt_;
  Scalar timeout_;
  Scalar fraction_;  ///< Fraction of a correction that a tick makes.
  Scalar slow_;
  bool learns_;
  bool known_ = false;  ///< Whether a stamp was accepted.
  double newest_;       ///< [s] A float does not resolve milliseconds after some hours.
  Scalar age_{0};
  Scalar half_{0};               ///< Time in the current half of the window [s].
  Scalar least_{kNone};          ///< Smallest delay in this half [s].
  Scalar least_before_{kNone};   ///< Smallest delay in the previous half [s].
  int rejected_ = 0;             ///< Number of stamps in the run of rejected stamps.
  double first_rejected_ = 0.0;  ///< First stamp of the run [s].
  double last_rejected_ = 0.0;   ///< Last stamp of the run [s].
  Scalar rejected_for_{0};       ///< Time since the run began [s].
};

}  // namespace fpbm
