#pragma once

#include "fpbm/core/validation.hpp"
#include "fpbm/task/path.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Follows a path from a tip by a clock of its own, which can pause and resume: the tip stays on the path, and its
/// velocity and acceleration do not jump.
///
/// The clock's rate r goes between 0 and 1 by a cubic in time; the reference is x(p), x′(p) r, x″(p) r² + x′(p) ṙ at
/// path time p = ∫ r dt, and at rest on the path's end from then on.
template <typename Path_>
class PathFollower {
 public:
  using Path = Path_;
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;
  using Point = typename Space::template Point<Scalar>;

  /// start: the path's origin in the base frame. ramp: duration of a pause or a resumption [s].
  /// Throws std::invalid_argument unless ramp is positive.
  PathFollower(const Path& path, const Point& start, Scalar ramp = Scalar(0.5))
      : path_(path), start_(start), ramp_(ramp), elapsed_(ramp) {
    validation::require_positive("ramp", static_cast<double>(ramp));
    end_ = Space::template compose<Scalar>(start, path.sample(path.duration()).x);
  }

  void pause() noexcept { go_to(Scalar(0)); }
  void resume() noexcept { go_to(Scalar(1)); }

  /// Path time [s], and whether it has reached the path's end.
  [[nodiscard]] Scalar time() const noexcept { return time_; }
  [[nodiscard]] bool done() const noexcept { return time_ >= path_.duration(); }

  /// Reference some seconds from now.
  [[nodiscard]] Reference<Space, Scalar> ahead(Scalar seconds) const noexcept {
    const Scalar p = steady() ? time_ + to_ * seconds : time_ + way(elapsed_ + seconds) - way(elapsed_);
    if (time_ >= path_.duration() || p > path_.duration()) return Reference<Space, Scalar>::hold(end_);
    Reference<Space, Scalar> reference = sample_within(path_, p, time_);
    const auto [r, rd] = rate(elapsed_ + seconds);
    reference.x = Space::template compose<Scalar>(start_, reference.x);
    reference.xdd = reference.xdd * (r * r) + reference.xd * rd;
    reference.xd *= r;
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
    time_ += way(elapsed_ + seconds) - way(elapsed_);
    elapsed_ += seconds;
    if (steady()) {
      elapsed_ = ramp_;
      slope_ = curvature_ = ticks_ = Scalar(0);
      from_ = to_;
    }
  }

 private:
  struct Rate {
    Scalar r;
    Scalar rd;
  };

  /// Takes the rate to target, from its present value and slope, along a cubic.
  void go_to(Scalar target) noexcept {
    const auto [r, rd] = rate(elapsed_);
    from_ = r;
    to_ = target;
    slope_ = rd * ramp_;
    curvature_ = Scalar(3) * (target - r) - Scalar(2) * slope_;
    elapsed_ = Scalar(0);
  }

  /// Whether the rate is constant.
  [[nodiscard]] bool steady() const noexcept { return elapsed_ >= ramp_; }

  [[nodiscard]] Scalar cubic() const noexcept { return to_ - from_ - slope_ - curvature_; }

  [[nodiscard]] Rate rate(Scalar elapsed) const noexcept {
    const Scalar v = elapsed / ramp_;
    if (v >= Scalar(1)) return {to_, Scalar(0)};
    return {from_ + v * (slope_ + v * (curvature_ + v * cubic())),
            (slope_ + v * (Scalar(2) * curvature_ + Scalar(3) * v * cubic())) / ramp_};
  }

  /// ∫ r dt since the cubic began.
  [[nodiscard]] Scalar way(Scalar elapsed) const noexcept {
    const Scalar whole = elapsed < ramp_ ? elapsed : ramp_;
    const Scalar v = whole / ramp_;
    const Scalar along =
        v * (from_ + v * (slope_ / Scalar(2) + v * (curvature_ / Scalar(3) + v * cubic() / Scalar(4))));
    return ramp_ * along + (elapsed - whole) * to_;
  }

  Path path_;
  Point start_;
  Point end_;
  Scalar ramp_;
  Scalar time_{0};
  Scalar since_{0};  ///< Path time at the first of the equal ticks.
  Scalar tick_{0};   ///< Length of an equal tick [s].
  Scalar ticks_{0};  ///< Number of equal ticks.
  Scalar elapsed_;   ///< Since the cubic began [s].
  Scalar from_{1};
  Scalar to_{1};
  Scalar slope_{0};
  Scalar curvature_{0};
};

}  // namespace fpbm
