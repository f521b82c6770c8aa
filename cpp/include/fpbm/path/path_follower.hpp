#pragma once

#include <algorithm>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// Follows a path from the position of a tip. The follower has a clock that can pause and resume. The reference stays
/// on the path, and the clock does not cause jumps of the reference velocity and acceleration.
///
/// The reference at the path time p = ∫ r dt is x(p), x′(p) r, x″(p) r² + x′(p) ṙ. After the end of the path, the
/// reference is at rest there. The rate r of the clock changes to 0 or 1 along a cubic in time. The duration of the
/// cubic is one ramp (argument of the constructor).
///
/// If a call reverses a running transition, ṙ first decreases to zero at |r̈| = 6/ramp². The cubics leave enough range
/// of r for the reversal. If r already changes toward its new value so fast that the cubic would overshoot, a shorter
/// cubic is used. Therefore r is always in [0, 1], |ṙ| ≤ 1.5/ramp, |r̈| ≤ 8/ramp², and a transition takes at most 1.25
/// ramps.
template <typename Path_>
class PathFollower {
 public:
  using Path = Path_;
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;
  using Point = typename Space::template Point<Scalar>;

  /// start: origin of the path in the base frame. ramp: duration of a pause from full speed, or of a resumption [s].
  /// With the default, x′(p) ṙ is at most 3 /s times the velocity of the path. Throws std::invalid_argument if ramp is
  /// not positive.
  PathFollower(const Path& path, const Point& start, Scalar ramp = Scalar(0.5))
      : path_(path), start_(start), ramp_(ramp), elapsed_(ramp) {
    validation::require_positive("ramp", ramp);
    end_ = Space::template compose<Scalar>(start, path.sample(path.duration()).x);
  }

  /// Repeated calls have no effect.
  void pause() noexcept { start_transition(Scalar(0)); }
  void resume() noexcept { start_transition(Scalar(1)); }

  /// Path time p [s], and whether the path has ended.
  [[nodiscard]] Scalar time() const noexcept { return time_; }
  [[nodiscard]] bool done() const noexcept { return time_ >= path_.duration(); }

  /// Reference after `seconds` [s].
  [[nodiscard]] Reference<Space, Scalar> ahead(Scalar seconds) const noexcept {
    const Scalar p = time_ + (is_constant() ? target_ * seconds : path_time(seconds));
    if (time_ >= path_.duration() || p > path_.duration()) return Reference<Space, Scalar>::hold(end_);
    Reference<Space, Scalar> reference = sample_within(path_, p, time_);
    const auto [r, rd] = rate(elapsed_ + seconds);
    reference.x = Space::template compose<Scalar>(start_, reference.x);
    Vector<Space::kRows, Scalar>& xd = reference.xd;
    Vector<Space::kRows, Scalar>& xdd = reference.xdd;
    for (int i = 0; i < Space::kRows; ++i) {
      xdd.coeffRef(i) = xdd.coeff(i) * (r * r) + xd.coeff(i) * rd;
      xd.coeffRef(i) *= r;
    }
    return reference;
  }

  /// Advances the clock by `seconds` [s].
  void advance(Scalar seconds) noexcept {
    if (is_constant()) {
      // Counts equal ticks, since a sum of their lengths would accumulate round-off errors.
      if (ticks_ == Scalar(0) || seconds != tick_) {
        first_time_ = time_;
        tick_ = seconds;
        ticks_ = Scalar(0);
      }
      ticks_ += Scalar(1);
      time_ = first_time_ + target_ * tick_ * ticks_;
      return;
    }
    time_ += path_time(seconds);
    elapsed_ += seconds;
  }

 private:
  struct Rate {
    Scalar r;
    Scalar rd;
  };

  /// Starts the transition of the rate r to target, 0 or 1, from its present value and slope.
  ///
  /// In the equations, time is in ramps. The gap is |target − r|. The slope of the gap is defined as −d(gap)/dt:
  /// positive while r approaches target.
  ///
  /// slope_ < 0: r moves away from target. At first, the slope increases by 6 per ramp, and is zero after
  /// reversal_ = −slope_/6 ramps. During the reversal, the gap increases by slope_²/12. Then a cubic of one ramp brings
  /// the gap from cubic_gap_ to zero.
  ///
  /// slope_ ≥ 0: a cubic brings the gap to zero. At its start, the cubic has the slope slope_. The duration of the
  /// cubic is one ramp, or 3 gap_/slope_ if the cubic would overshoot in one ramp.
  void start_transition(Scalar target) noexcept {
    if (target == target_) return;
    const auto [r, rd] = rate(elapsed_);
    slope_ = (target > target_ ? rd : -rd) * ramp_;
    // The remaining range of r in the direction of its slope is always at least least_gap. max() and min() correct
    // round-off errors only.
    const Scalar least_gap = slope_ * slope_ / Scalar(12);
    gap_ = target > r ? target - r : r - target;
    if (slope_ < Scalar(0)) {
      reversal_ = -slope_ / Scalar(6);
      cubic_gap_ = std::min(gap_ + least_gap, Scalar(1));
      cubic_duration_ = Scalar(1);
      cubic_slope_ = Scalar(0);
    } else {
      reversal_ = Scalar(0);
      cubic_gap_ = gap_ = std::max(gap_, least_gap);
      cubic_duration_ = slope_ > Scalar(3) * gap_ ? Scalar(3) * gap_ / slope_ : Scalar(1);
      cubic_slope_ = slope_ * cubic_duration_;
    }
    target_ = target;
    elapsed_ = ticks_ = Scalar(0);
  }

  /// Whether the rate is constant.
  [[nodiscard]] bool is_constant() const noexcept { return elapsed_ / ramp_ >= reversal_ + cubic_duration_; }

  /// r and ṙ after `elapsed` [s] of the transition.
  [[nodiscard]] Rate rate(Scalar elapsed) const noexcept {
    const Scalar v = elapsed / ramp_;
    if (v >= reversal_ + cubic_duration_) return {target_, Scalar(0)};
    Scalar gap = gap_ - v * (slope_ + Scalar(3) * v);
    Scalar slope = slope_ + Scalar(6) * v;
    if (v >= reversal_) {
      const Scalar w = (v - reversal_) / cubic_duration_;
      const Scalar remaining = Scalar(1) - w;
      gap = remaining * remaining * (cubic_gap_ + coefficient() * w);
      slope = remaining * (cubic_slope_ + Scalar(3) * coefficient() * w) / cubic_duration_;
    }
    gap = std::clamp(gap, Scalar(0), Scalar(1));  // Outside by round-off only.
    return target_ == Scalar(0) ? Rate{gap, -slope / ramp_} : Rate{Scalar(1) - gap, slope / ramp_};
  }

  /// Coefficient of the cubic: the gap is (1 − w)² (cubic_gap_ + coefficient() w) after the fraction w of the duration
  /// cubic_duration_.
  [[nodiscard]] Scalar coefficient() const noexcept { return Scalar(2) * cubic_gap_ - cubic_slope_; }

  /// ∫ r dt over the next `seconds` [s], clipped to the interval from 0 to `seconds`.
  [[nodiscard]] Scalar path_time(Scalar seconds) const noexcept {
    const Scalar gap = ramp_ * (gaps((elapsed_ + seconds) / ramp_) - gaps(elapsed_ / ramp_));
    const Scalar whole = target_ == Scalar(0) ? gap : seconds - gap;
    return std::clamp(whole, std::min(seconds, Scalar(0)), std::max(seconds, Scalar(0)));
  }

  /// ∫ |target_ − r| dv over the first v ramps of the transition.
  [[nodiscard]] Scalar gaps(Scalar v) const noexcept {
    const Scalar first = std::min(v, reversal_);
    const Scalar w = std::clamp((v - reversal_) / cubic_duration_, Scalar(0), Scalar(1));
    const Scalar square_integral = w * (Scalar(1) - w * (Scalar(1) - w / Scalar(3)));  // ∫ (1 − w)² dw
    const Scalar product_integral =
        w * w * (Scalar(0.5) - w * (Scalar(2) / Scalar(3) - w / Scalar(4)));  // ∫ w (1 − w)² dw
    return first * (gap_ - first * (slope_ / Scalar(2) + first)) +
           cubic_duration_ * (cubic_gap_ * square_integral + coefficient() * product_integral);
  }

  Path path_;
  Point start_;
  Point end_;
  Scalar ramp_;
  Scalar time_{0};
  Scalar first_time_{0};  ///< Path time at the first of the equal ticks.
  Scalar tick_{0};        ///< Length of an equal tick [s].
  Scalar ticks_{0};       ///< Number of equal ticks.

  // The transition since the last call of start_transition(), with time in ramps: gap |target_ − r|, its slope
  // −d(gap)/dt, and durations.
  Scalar elapsed_;            ///< Time since the call [s].
  Scalar target_{1};          ///< Target of the rate.
  Scalar gap_{0};             ///< At the call.
  Scalar slope_{0};           ///< At the call; negative if r moves away from target_.
  Scalar reversal_{0};        ///< Duration in which a negative slope increases to zero.
  Scalar cubic_gap_{0};       ///< Gap at the start of the cubic.
  Scalar cubic_slope_{0};     ///< Slope at the start of the cubic, with time in durations of the cubic.
  Scalar cubic_duration_{1};  ///< Duration of the cubic.
};

}  // namespace fpbm
