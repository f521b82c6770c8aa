#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/arc_length.hpp"
#include "fpbm/path/detail/curve.hpp"
#include "fpbm/path/path.hpp"

namespace fpbm {

/// Throws std::invalid_argument unless a path is at rest with zero acceleration at an end [s].
template <typename Path>
void require_rest(const Path& path, double end) {
  constexpr double kRest = 1e-9;  // [m, rad], for the round-off errors of splines.
  const double duration = path.duration();
  const auto at = path.sample(end);
  if (!(duration * (at.xd.norm() + duration * at.xdd.norm()) < kRest)) {
    validation::reject("path", ": must begin and end at rest with zero acceleration: use the time law Quintic");
  }
}

/// A path from rest to rest with another parameter p, so that the tip can move at the start, at the end or at both
/// ends: x′(p) is not zero there. Up to the first stop, and from the last stop, x(p) is the point at the distance s(p)
/// along the path, at rest at the stop. Between these stops, p is the time of the given path.
template <typename Path>
class MovingEnds {
 public:
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;

  /// moving: whether the tip moves at the start and at the end. Throws std::invalid_argument as ArcLength does, unless
  /// the given path begins and ends at rest with zero acceleration, and if its curvature is not bounded at an end where
  /// the tip moves.
  MovingEnds(const Path& path, const std::array<bool, 2>& moving) : distances_(path), moving_(moving) {
    require_rest(path, 0.0);
    require_rest(path, path.duration());
    if (moving_[0]) require_curvature(distances_.parts().front(), false);
    if (moving_[1]) require_curvature(distances_.parts().back(), true);
  }

  [[nodiscard]] Scalar duration() const noexcept { return distances_.path().duration(); }

  /// Whether the tip moves at the start (0) or at the end (1).
  [[nodiscard]] bool moves(std::size_t end) const noexcept { return moving_[end]; }

  /// Time of the given path at a parameter [s].
  [[nodiscard]] Scalar time(Scalar p) const noexcept {
    const Place place = at(p);
    return place.part == nullptr ? p : distances_.time(*place.part, place.along.s);
  }

  /// x, x′ and x″ at a parameter 0 ≤ p ≤ duration().
  [[nodiscard]] Reference<Space, Scalar> sample(Scalar p) const noexcept {
    const auto [part, along] = at(p);
    if (part == nullptr) return distances_.path().sample(p);
    const Curve<Space, Scalar> curve = distances_.at(*part, along.s);
    return {curve.d, curve.d1 * along.sd, curve.d2 * (along.sd * along.sd) + curve.d1 * along.sdd};
  }

 private:
  using Part = typename ArcLength<Path>::Part;

  /// The part at a parameter, and the distance along the part with its derivatives; no part where p is a time.
  struct Place {
    const Part* part;
    Phase<Scalar> along;
  };

  [[nodiscard]] Place at(Scalar p) const noexcept {
    const auto& parts = distances_.parts();
    const Part& first = parts.front();
    const Part& last = parts.back();
    if (moving_[0] && p <= first.cells.t.back()) {
      const bool whole = moving_[1] && parts.size() == 1;
      return on(first, p, Scalar(0), whole ? duration() : first.cells.t.back(), false, !whole);
    }
    if (moving_[1] && p >= last.cells.t.front()) return on(last, p, last.cells.t.front(), duration(), true, false);
    return {nullptr, {}};
  }

  /// The distance along a part between the parameters `begin` and `end`: s = τ, or with τ³ at the end of the part that
  /// is at rest, so that velocity and acceleration are zero there.
  static Place on(const Part& part, Scalar p, Scalar begin, Scalar end, bool rest_at_begin, bool rest_at_end) noexcept {
    const Scalar width = end - begin;
    const Scalar tau = std::clamp((p - begin) / width, Scalar(0), Scalar(1));
    const Scalar left = Scalar(1) - tau;
    Phase<Scalar> phase{tau, Scalar(1), Scalar(0)};
    if (rest_at_begin) phase = {tau * tau * tau, Scalar(3) * tau * tau, Scalar(6) * tau};
    if (rest_at_end) phase = {Scalar(1) - left * left * left, Scalar(3) * left * left, Scalar(-6) * left};
    const Scalar unit = part.length() / width;
    return {&part, {phase.s * part.length(), phase.sd * unit, phase.sdd * unit / width}};
  }

  /// The curvature of a spline from rest, as of Waypoints, is not bounded at its ends: x = c t³ + d t⁴ with s ~ t³.
  void require_curvature(const Part& part, bool at_end) const {
    const auto curvature = [&](Scalar fraction) {
      const Scalar length = part.length();
      const auto d2 = distances_.at(part, (at_end ? Scalar(1) - fraction : fraction) * length).d2;
      constexpr int kLinear = Space::kRows - Space::kTurns;
      return length *
             std::max(d2.template head<kLinear>().norm(), length * d2.template tail<Space::kRows - kLinear>().norm());
    };
    constexpr Scalar kNear(1e-8);  // Fractions of the length. In a cusp, the ratio of the curvatures is at least 10.
    constexpr Scalar kFurther(1e-5);
    constexpr Scalar kRatio(3);
    if (curvature(kNear) > std::max(Scalar(1), kRatio * curvature(kFurther))) {
      validation::reject("path", ": has no bounded curvature at its ", at_end ? "end" : "start",
                         ", as Waypoints and cusps, so that the tip must be at rest there: give no ",
                         at_end ? "end_speed" : "start_speed", ", or use Line, Circle, Lissajous or Polyline");
    }
  }

  ArcLength<Path> distances_;
  std::array<bool, 2> moving_;
};

}  // namespace fpbm
