#pragma once

#include <algorithm>

#include "fpbm/core/validation.hpp"
#include "fpbm/task/path.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Follows a path from a tip by a clock of its own, which can pause and resume: the tip stays on the path, and its
/// velocity and acceleration do not jump.
///
/// The reference is x(p), x′(p) r, x″(p) r² + x′(p) ṙ at path time p = ∫ r dt, and at rest on the path's end from then
/// on. The clock's rate r goes to 0 or 1 by a cubic in time. One that is called back first loses its slope at
/// |r̈| = 6/ramp², which the cubics leave room for; one that has slope already takes a shorter cubic where the usual one
/// would go too far. So r never leaves [0, 1], |ṙ| ≤ 1.5/ramp, |r̈| ≤ 8/ramp², and no call takes more than 1.25 ramps.
template <typename Path_>
class PathFollower {
 public:
  using Path = Path_;
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;
  using Point = typename Space::template Point<Scalar>;

  /// start: the path's origin in the base frame. ramp: duration of a pause from full speed, or a resumption [s].
  /// Throws std::invalid_argument unless ramp is positive.
  PathFollower(const Path& path, const Point& start, Scalar ramp = Scalar(0.5))
      : path_(path), start_(start), ramp_(ramp), elapsed_(ramp) {
    validation::require_positive("ramp", ramp);
    end_ = Space::template compose<Scalar>(start, path.sample(path.duration()).x);
  }

  /// Both do nothing where that is under way already.
  void pause() noexcept { go_to(Scalar(0)); }
  void resume() noexcept { go_to(Scalar(1)); }

  /// Path time [s], and whether it has reached the path's end.
  [[nodiscard]] Scalar time() const noexcept { return time_; }
  [[nodiscard]] bool done() const noexcept { return time_ >= path_.duration(); }

  /// Reference some seconds from now.
  [[nodiscard]] Reference<Space, Scalar> ahead(Scalar seconds) const noexcept {
    const Scalar p = time_ + (steady() ? to_ * seconds : way(seconds));
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

  /// Advances the clock.
  void advance(Scalar seconds) noexcept {
    if (steady()) {
      // Counts equal ticks, since a sum of their lengths would gather round-off.
      if (ticks_ == Scalar(0) || seconds != tick_) {
        since_ = time_;
        tick_ = seconds;
        ticks_ = Scalar(0);
      }
      ticks_ += Scalar(1);
      time_ = since_ + to_ * tick_ * ticks_;
      return;
    }
    time_ += way(seconds);
    elapsed_ += seconds;
  }

 private:
  struct Rate {
    Scalar r;
    Scalar rd;
  };

  /// Takes the rate to target, from its present value and slope.
  void go_to(Scalar target) noexcept {
    if (target == to_) return;
    const auto [r, rd] = rate(elapsed_);
    slope_ = (target > to_ ? rd : -rd) * ramp_;
    // The room to lose the slope in is there, on the side that it leads to: max() and min() are for round-off.
    const Scalar room = slope_ * slope_ / Scalar(12);
    gap_ = target > r ? target - r : r - target;
    if (slope_ < Scalar(0)) {
      brakes_ = -slope_ / Scalar(6);
      left_ = std::min(gap_ + room, Scalar(1));
      lasts_ = Scalar(1);
      push_ = Scalar(0);
    } else {
      brakes_ = Scalar(0);
      left_ = gap_ = std::max(gap_, room);
      lasts_ = slope_ > Scalar(3) * gap_ ? Scalar(3) * gap_ / slope_ : Scalar(1);
      push_ = slope_ * lasts_;
    }
    to_ = target;
    elapsed_ = ticks_ = Scalar(0);
  }

  /// Whether the rate is constant.
  [[nodiscard]] bool steady() const noexcept { return elapsed_ / ramp_ >= brakes_ + lasts_; }

  [[nodiscard]] Rate rate(Scalar elapsed) const noexcept {
    const Scalar v = elapsed / ramp_;
    if (v >= brakes_ + lasts_) return {to_, Scalar(0)};
    Scalar gap = gap_ - v * (slope_ + Scalar(3) * v);
    Scalar slope = slope_ + Scalar(6) * v;
    if (v >= brakes_) {
      const Scalar w = (v - brakes_) / lasts_;
      const Scalar rest = Scalar(1) - w;
      gap = rest * rest * (left_ + bend() * w);
      slope = rest * (push_ + Scalar(3) * bend() * w) / lasts_;
    }
    gap = std::clamp(gap, Scalar(0), Scalar(1));  // It is, but for round-off.
    return to_ == Scalar(0) ? Rate{gap, -slope / ramp_} : Rate{Scalar(1) - gap, slope / ramp_};
  }

  [[nodiscard]] Scalar bend() const noexcept { return Scalar(2) * left_ - push_; }

  /// ∫ r dt over some seconds from now, within 0 and all of them.
  [[nodiscard]] Scalar way(Scalar seconds) const noexcept {
    const Scalar gap = ramp_ * (gaps((elapsed_ + seconds) / ramp_) - gaps(elapsed_ / ramp_));
    const Scalar whole = to_ == Scalar(0) ? gap : seconds - gap;
    return std::clamp(whole, std::min(seconds, Scalar(0)), std::max(seconds, Scalar(0)));
  }

  /// ∫ |to − r| dv from the call to v ramps after it.
  [[nodiscard]] Scalar gaps(Scalar v) const noexcept {
    const Scalar first = std::min(v, brakes_);
    const Scalar w = std::clamp((v - brakes_) / lasts_, Scalar(0), Scalar(1));
    const Scalar even = w * (Scalar(1) - w * (Scalar(1) - w / Scalar(3)));                    // ∫ (1 − w)² dw
    const Scalar late = w * w * (Scalar(0.5) - w * (Scalar(2) / Scalar(3) - w / Scalar(4)));  // ∫ w (1 − w)² dw
    return first * (gap_ - first * (slope_ / Scalar(2) + first)) + lasts_ * (left_ * even + bend() * late);
  }

  Path path_;
  Point start_;
  Point end_;
  Scalar ramp_;
  Scalar time_{0};
  Scalar since_{0};  ///< Path time at the first of the equal ticks.
  Scalar tick_{0};   ///< Length of an equal tick [s].
  Scalar ticks_{0};  ///< Number of equal ticks.

  // The transition: how far the rate is from to, its slope toward it, and durations, in ramps.
  Scalar elapsed_;  ///< Since the call [s].
  Scalar to_{1};
  Scalar gap_{0};  ///< At the call, as slope.
  Scalar slope_{0};
  Scalar brakes_{0};  ///< How long a slope away from to is lost.
  Scalar left_{0};    ///< Gap where the cubic begins,
  Scalar push_{0};    ///< its slope there, in cubics,
  Scalar lasts_{1};   ///< and how long it lasts.
};

}  // namespace fpbm
