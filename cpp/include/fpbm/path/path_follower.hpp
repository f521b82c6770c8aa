#pragma once

#include <algorithm>

#include "fpbm/core/detail/quickest_stop.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/kept_motion.hpp"
#include "fpbm/path/detail/time_optimal_axis.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// Follows a path from the position of a tip. The follower has a clock that can pause, resume and run at a fraction of
/// its speed. The reference stays on the path, and the clock does not cause jumps of the reference velocity and
/// acceleration.
///
/// The reference at the path time p = ∫ r dt is x(p), x′(p) r, x″(p) r² + x′(p) ṙ. After the end of the path, the
/// reference is at rest there. The rate r of the clock changes to another value in minimum time within |ṙ| ≤ 4/3/ramp
/// and |r̈| ≤ 16/3/ramp² (TimeOptimalAxis): from 0 to 1 in one ramp (argument of the constructor), and in at most 1.25
/// ramps if the change reverses another change. r is always in [0, 1].
///
/// A kept path (kept_path()) has priority over time: a tracker slows the clock instead of leaving the path, if the
/// limits or the bounds do not admit the motion.
template <typename Path_>
class PathFollower {
 public:
  using Path = Path_;
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;
  using Point = typename Space::template Point<Scalar>;

  /// start: origin of the path in the base frame. ramp: duration of a pause from full speed, or of a resumption [s].
  /// With the default, x′(p) ṙ is at most 2.7 /s times the velocity of the path. If the path is kept, the ramp is at
  /// least its least ramp (kept_path()). Throws std::invalid_argument if ramp is not positive.
  PathFollower(const Path& path, const Point& start, Scalar ramp = Scalar(0.5))
      : path_(path), start_(start), clock_{Scalar(1), {}} {
    validation::require_positive("ramp", ramp);
    if (kept() != nullptr) ramp = std::max(ramp, static_cast<Scalar>(kept()->ramp));
    clock_.stop = {Scalar(4) / (Scalar(3) * ramp), Scalar(16) / (Scalar(3) * ramp * ramp)};
    end_ = Space::template compose<Scalar>(start, path.sample(path.duration()).x);
  }

  /// Repeated calls have no effect.
  void pause() noexcept {
    paused_ = true;
    change_rate();
  }
  void resume() noexcept {
    paused_ = false;
    change_rate();
  }
  /// Largest rate of the clock, in [0, 1], for a tracker that stops on a kept path, or slows down near obstacles.
  void limit_rate(Scalar most) noexcept {
    most_rate_ = most;
    change_rate();
  }
  /// Changes the speed to a fraction of the speed of the path within a ramp; during a pause, after resume(). If the
  /// fraction is not in (0, 1], returns false without an effect.
  bool set_speed(Scalar fraction) noexcept {
    if (!(fraction > Scalar(0) && fraction <= Scalar(1))) return false;
    speed_ = fraction;
    change_rate();
    return true;
  }
  /// The fraction of the last call of set_speed().
  [[nodiscard]] Scalar speed() const noexcept { return speed_; }

  /// The motion along a kept path, or null.
  [[nodiscard]] const KeptMotion* kept() const noexcept { return motion_along(path_); }
  /// Posture and velocity of the joints on a kept path, now.
  template <int N>
  [[nodiscard]] State<N, Scalar> planned() const noexcept {
    return {kept()->template posture<N>(now_.q), kept()->template velocity<N>(now_.q) * now_.v};
  }
  /// Path time at which the clock stands after pause() [s].
  [[nodiscard]] Scalar stop_time() const noexcept { return clock_.stop.end_position(now_); }

  /// Path time p [s], and whether the path has ended.
  [[nodiscard]] Scalar time() const noexcept { return now_.q; }
  [[nodiscard]] bool done() const noexcept { return now_.q >= path_.duration(); }

  /// Reference after `seconds` ≥ 0 [s].
  [[nodiscard, gnu::noinline]] Reference<Space, Scalar> ahead(Scalar seconds) const noexcept {
    const auto [p, r, rd] = after(seconds);
    if (done() || p > path_.duration()) return Reference<Space, Scalar>::hold(end_);
    Reference<Space, Scalar> reference = sample_within(path_, p, now_.q);
    reference.x = Space::template compose<Scalar>(start_, reference.x);
    Vector<Space::kRows, Scalar>& xd = reference.xd;
    Vector<Space::kRows, Scalar>& xdd = reference.xdd;
    for (int i = 0; i < Space::kRows; ++i) {
      xdd.coeffRef(i) = xdd.coeff(i) * (r * r) + xd.coeff(i) * rd;
      xd.coeffRef(i) *= r;
    }
    return reference;
  }

  /// Largest fraction for advance() with which the rate of the clock is at most 1; 1 while the clock stands.
  [[nodiscard]] Scalar most_fraction() const noexcept {
    const Scalar fastest = std::max(now_.v, rate_);
    return fastest > Scalar(0) ? std::max(Scalar(1) / fastest, Scalar(1)) : Scalar(1);
  }

  /// Advances the clock by `seconds` [s]. fraction: rate at the end of the tick, relative to the rate of the reference
  /// (Tick::path_fraction). At velocity level, the rate is constant in the tick; at acceleration level, ṙ is constant.
  void advance(Scalar seconds, Scalar fraction = Scalar(1), Level level = Level::kVelocity) noexcept {
    if (fraction != Scalar(1)) {
      const AxisState<Scalar> next = after(seconds);
      const Scalar displacement = level == Level::kVelocity
                                      ? fraction * (next.q - now_.q)
                                      : next.q - now_.q - (Scalar(1) - fraction) * next.v * seconds / Scalar(2);
      now_ = {now_.q + std::max(displacement, Scalar(0)), std::min(fraction * next.v, Scalar(1)), Scalar(0)};
      ticks_ = Scalar(0);
      return;
    }
    if (!is_steady()) {
      now_ = after(seconds);
      return;
    }
    // Counts equal ticks, since a sum of their lengths would accumulate round-off errors.
    if (ticks_ == Scalar(0) || seconds != tick_) {
      first_time_ = now_.q;
      tick_ = seconds;
      ticks_ = Scalar(0);
    }
    ticks_ += Scalar(1);
    now_.q = first_time_ + rate_ * tick_ * ticks_;
  }

 private:
  void change_rate() noexcept {
    const Scalar rate = paused_ ? Scalar(0) : std::min(speed_, most_rate_);
    if (rate == rate_) return;
    rate_ = rate;
    ticks_ = Scalar(0);
  }

  [[nodiscard]] bool is_steady() const noexcept { return now_.v == rate_ && now_.a == Scalar(0); }

  /// p, r and ṙ after `seconds` [s]. The bounds on p and r correct round-off errors only.
  [[nodiscard]] AxisState<Scalar> after(Scalar seconds) const noexcept {
    if (is_steady()) return {now_.q + rate_ * seconds, rate_, Scalar(0)};
    AxisState<Scalar> next = clock_.change(now_, rate_, seconds);
    next.q = std::clamp(next.q, now_.q, now_.q + seconds);
    next.v = std::clamp(next.v, Scalar(0), Scalar(1));
    return next;
  }

  Path path_;
  Point start_;
  Point end_;
  bool paused_ = false;
  Scalar most_rate_{1};  ///< limit_rate()
  TimeOptimalAxis<Scalar> clock_;
  AxisState<Scalar> now_{Scalar(0), Scalar(1), Scalar(0)};  ///< p, r and ṙ.
  Scalar rate_{1};                                          ///< The clock changes its rate to this rate.
  Scalar speed_{1};                                         ///< Rate after resume().
  Scalar first_time_{0};                                    ///< Path time at the first of the equal ticks.
  Scalar tick_{0};                                          ///< Length of an equal tick [s].
  Scalar ticks_{0};                                         ///< Number of equal ticks.
};

}  // namespace fpbm
