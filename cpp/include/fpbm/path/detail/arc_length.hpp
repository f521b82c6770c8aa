#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/curve.hpp"
#include "fpbm/path/detail/path_length.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// The geometry of a path as a function of the distance along the path [m], in parts between the places where the path
/// stops or changes its direction abruptly. Allocates at construction and when copied, never in at().
template <typename Path>
class ArcLength {
  using Lengths = PathLength<Path>;
  using Cells = typename Lengths::Cells;

 public:
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;

  struct Part {
    Cells cells;
    Scalar first;  ///< At a stop, xd is zero: the direction at the start of the part is the direction at this time [s].
    Scalar last;   ///< Also for the end of the part.
    [[nodiscard]] Scalar length() const noexcept { return cells.s.back(); }
  };

  /// Throws std::invalid_argument unless the path is finite, has a length, and never rotates the tip without
  /// moving the tip in position.
  explicit ArcLength(const Path& path) : lengths_(path) {
    const Scalar T = path.duration();
    Scalar length(0);
    Scalar round_off(0);
    for (int k = 0; k < kIntervals; ++k) {
      const Scalar t = T * Scalar(k) / Scalar(kIntervals);
      length += lengths_.length(t, t + T / Scalar(kIntervals));
      round_off = std::max(round_off, lengths_.round_off(t, kTolerance * T));
    }
    if (!std::isfinite(length)) validation::reject("path", ": must have finite velocities");
    // Coordinates that are large compared to the length of the path have large round-off errors.
    const Scalar tolerance = std::max(kTolerance * length, Scalar(8) * round_off);
    if (!(tolerance > std::numeric_limits<Scalar>::min()) || !(length > tolerance)) {
      validation::reject("path", ": has no length: must move the tip in position");
    }
    const std::vector<Scalar> stops = stops_of(lengths_.cells(Scalar(0), T, kIntervals, tolerance));
    for (std::size_t i = 1; i < stops.size(); ++i) {
      Part part{lengths_.cells(stops[i - 1], stops[i], kPartIntervals, tolerance), stops[i - 1], stops[i]};
      if (part.length() > tolerance) {
        const Scalar near = std::sqrt(std::numeric_limits<Scalar>::epsilon()) / Scalar(16) * part.length();
        part.first = lengths_.time(part.cells, near);
        part.last = lengths_.time(part.cells, part.length() - near);
        parts_.push_back(part);
      } else if constexpr (Space::kTurns > 0) {
        const Twist turned = Space::template difference<Scalar>(path.sample(stops[i]).x, path.sample(stops[i - 1]).x);
        if (turned.template tail<Space::kTurns>().norm() > kSmall) {
          validation::reject("path", ": rotates the tip in one place at t = ", stops[i],
                             " s: must also move the tip in position");
        }
      }
    }
  }

  [[nodiscard]] const Path& path() const noexcept { return lengths_.path(); }
  [[nodiscard]] const std::vector<Part>& parts() const noexcept { return parts_; }

  /// Time of the path at a distance from the start of a part [s].
  [[nodiscard]] Scalar time(const Part& part, Scalar distance) const noexcept {
    return lengths_.time(part.cells, distance);
  }

  /// Point of the path at a distance from the start of a part, and its first two derivatives with respect to the
  /// distance.
  [[nodiscard]] Curve<Space, Scalar> at(const Part& part, Scalar distance) const noexcept {
    constexpr int kLinear = Lengths::kLinear;
    const Scalar t = time(part, distance);
    Reference<Space, Scalar> here = path().sample(t);
    const auto point = here.x;
    if (const Scalar moving = std::clamp(t, part.first, part.last); moving != t) here = path().sample(moving);
    const Scalar v = here.xd.template head<kLinear>().norm();
    const Twist d1 = here.xd / v;
    const Scalar vd = d1.template head<kLinear>().dot(here.xdd.template head<kLinear>());
    return {point, d1, (here.xdd - d1 * vd) / (v * v)};
  }

 private:
  using Twist = Vector<Space::kRows, Scalar>;

  static constexpr int kIntervals = 64;     // Of the whole path, before halvings: 16 to 256 pass AtSpeed.*.
  static constexpr int kPartIntervals = 8;  // Of a part, before halvings: 2 to 32 pass AtSpeed.*.
  static constexpr Scalar kTolerance =
      Scalar(512) * std::numeric_limits<Scalar>::epsilon();  // Ratio to the whole length.
  // Smallest speed, of the largest speed, that is not a stop; smallest abrupt change of direction [rad].
  static constexpr Scalar kSmall = Scalar(sizeof(Scalar) < 8 ? 2e-2 : 1e-6);

  /// Times at which the path stops or changes its direction abruptly, and both ends.
  [[nodiscard]] std::vector<Scalar> stops_of(const Cells& whole) const {
    const Scalar T = whole.t.back();
    const Scalar apart = kTolerance * T;
    const Scalar near = kSmall / Scalar(1024) * T;  // The cells at an abrupt change of direction are smaller.
    std::vector<Scalar> times{Scalar(0)};           // Four per cell: the speed is smooth in a cell.
    for (std::size_t i = 1; i < whole.t.size(); ++i) {
      for (int k = 1; k <= 4; ++k) {
        times.push_back(whole.t[i - 1] + (whole.t[i] - whole.t[i - 1]) * static_cast<Scalar>(k) / Scalar(4));
      }
    }
    std::vector<Scalar> speeds;
    for (const Scalar t : times) speeds.push_back(lengths_.speed(t));
    const Scalar stopped = kSmall * *std::max_element(speeds.begin(), speeds.end());
    std::vector<Scalar> stops{Scalar(0)};
    const auto add = [&](Scalar t) {
      if (t > stops.back() + apart && t < T - apart) stops.push_back(t);
    };
    for (std::size_t i = 1; i + 1 < times.size(); ++i) {
      const Scalar low = times[i] - near;
      const Scalar high = times[i] + near;
      if (speeds[i] <= std::min(speeds[i - 1], speeds[i + 1]) &&
          Scalar(2) * speeds[i] <= std::max(speeds[i - 1], speeds[i + 1])) {
        const Scalar t = slowest(times[i - 1], times[i + 1]);
        if (lengths_.speed(t) <= stopped) add(t);
      }
      if (turn(low, high) > kSmall && std::min(lengths_.speed(low), lengths_.speed(high)) > stopped) {
        const Scalar corner = sharpest(low, high);
        if (turn(corner, corner + apart) > kSmall || turn(corner - apart, corner) > kSmall) add(corner);
      }
    }
    stops.push_back(T);
    return stops;
  }

  /// Difference of the directions at two times.
  [[nodiscard]] Scalar turn(Scalar a, Scalar b) const noexcept {
    return (lengths_.velocity(a).normalized() - lengths_.velocity(b).normalized()).norm();
  }

  /// Time of the largest change of direction between two times, by bisection.
  [[nodiscard]] Scalar sharpest(Scalar a, Scalar b) const noexcept {
    for (Scalar middle = (a + b) / Scalar(2); a < middle && middle < b; middle = (a + b) / Scalar(2)) {
      (turn(a, middle) > turn(middle, b) ? b : a) = middle;
    }
    return b;
  }

  /// Time of the least speed between two times, by ternary search.
  [[nodiscard]] Scalar slowest(Scalar a, Scalar b) const noexcept {
    for (int k = 0; k < 100; ++k) {
      const Scalar third = (b - a) / Scalar(3);
      if (lengths_.speed(a + third) < lengths_.speed(b - third)) {
        b -= third;
      } else {
        a += third;
      }
    }
    return (a + b) / Scalar(2);
  }

  Lengths lengths_;
  std::vector<Part> parts_;
};

}  // namespace fpbm
