#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/path/path.hpp"

namespace fpbm {

/// Length in position of the pieces of a path, and the time at a distance along a piece.
template <typename Path>
class PathLength {
 public:
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;
  static constexpr int kLinear = Space::kRows - Space::kTurns;
  using Linear = Vector<kLinear, Scalar>;

  /// Cells [t[i], t[i + 1]] of the path's time [s], with the distance s[i] at t[i] [m].
  struct Cells {
    std::vector<Scalar> t;
    std::vector<Scalar> s;
  };

  explicit PathLength(const Path& path) : path_(path) {}

  [[nodiscard]] const Path& path() const noexcept { return path_; }
  [[nodiscard]] Linear velocity(Scalar t) const noexcept { return path_.sample(t).xd.template head<kLinear>(); }
  [[nodiscard]] Scalar speed(Scalar t) const noexcept { return velocity(t).norm(); }

  /// Cells of the piece between two times, whose lengths and displacements are exact to a tolerance [m]. The cells are
  /// halves, quarters and so on of `count` equal intervals.
  [[nodiscard]] Cells cells(Scalar begin, Scalar end, int count, Scalar tolerance) const {
    Cells result{{begin}, {Scalar(0)}};
    for (int k = 1; k <= count; ++k) {
      const Scalar a = result.t.back();
      const Scalar b = k == count ? end : begin + (end - begin) * static_cast<Scalar>(k) / static_cast<Scalar>(count);
      split(a, b, integral(a, b), kHalvings, tolerance, result);
    }
    return result;
  }

  /// Difference between the displacement from t to t + dt and the velocity, for a small dt: the round-off error.
  [[nodiscard]] Scalar round_off(Scalar t, Scalar dt) const noexcept {
    return (moved(t, t + dt) - dt * velocity(t)).norm();
  }

  /// Length of the piece between two times by Gauss's rule, without halvings.
  [[nodiscard]] Scalar length(Scalar a, Scalar b) const noexcept { return integral(a, b).length; }

  /// Time at a distance from the start of cells, by Newton's method within a bracket.
  [[nodiscard]] Scalar time(const Cells& cells, Scalar distance) const noexcept {
    const auto after = std::upper_bound(cells.s.begin() + 1, cells.s.end() - 1, distance);
    const auto i = static_cast<std::size_t>(after - cells.s.begin()) - 1;
    const Scalar start = cells.t[i];
    Scalar low = start;
    Scalar high = cells.t[i + 1];
    const Scalar width = high - low;
    const Scalar whole = cells.s[i + 1] - cells.s[i];
    const Scalar rest = std::clamp(distance - cells.s[i], Scalar(0), whole);
    // At a stop, the distance is a power of the time. Its exponent follows from the speed at the other end of the cell.
    const auto power = [&](Scalar fraction, Scalar t) {
      return std::pow(fraction, whole / std::max(whole, speed(t) * width));
    };
    Scalar t = low + width * rest / whole;
    if (i == 0) t = low + width * power(rest / whole, high);
    if (i + 2 == cells.t.size()) t = high - width * power(Scalar(1) - rest / whole, low);
    constexpr Scalar kExact = Scalar(2) * std::numeric_limits<Scalar>::epsilon();
    for (int k = 0; k < kHalvings; ++k) {
      const Scalar gap = length(start, t) - rest;
      if (std::abs(gap) <= kExact * cells.s.back()) break;
      (gap > Scalar(0) ? high : low) = t;
      const Scalar next = t - gap / speed(t);
      t = next > low && next < high ? next : (low + high) / Scalar(2);
    }
    return t;
  }

 private:
  static constexpr int kHalvings = 45;                   // Down to round-off of the time.
  static constexpr std::size_t kMostCells = 1UL << 16U;  // For paths with noise.

  [[nodiscard]] Linear moved(Scalar a, Scalar b) const noexcept {
    return Space::template difference<Scalar>(path_.sample(b).x, path_.sample(a).x).template head<kLinear>();
  }

  struct Integral {
    Scalar length;
    Linear displacement;
  };

  /// Gauss's rule with 8 points.
  [[nodiscard]] Integral integral(Scalar a, Scalar b) const noexcept {
    constexpr std::array<double, 4> kNodes{0.18343464249564980494, 0.52553240991632898582, 0.79666647741362673959,
                                           0.96028985649753623168};
    constexpr std::array<double, 4> kWeights{0.36268378337836198297, 0.31370664587788728734, 0.22238103445337447054,
                                             0.10122853629037625915};
    const Scalar middle = (a + b) / Scalar(2);
    const Scalar half = (b - a) / Scalar(2);
    Integral sum{Scalar(0), Linear::Zero()};
    for (std::size_t k = 0; k < kNodes.size(); ++k) {
      const Scalar offset = half * static_cast<Scalar>(kNodes[k]);
      const Scalar weight = half * static_cast<Scalar>(kWeights[k]);
      const Linear before = velocity(middle - offset);
      const Linear after = velocity(middle + offset);
      sum.length += weight * (before.norm() + after.norm());
      sum.displacement += weight * (before + after);
    }
    return sum;
  }

  /// Halves a cell until Gauss's rule is exact. The rule is not exact if the path stops or changes its direction.
  void split(Scalar a, Scalar b, const Integral& whole, int halvings, Scalar tolerance, Cells& cells) const {
    const Scalar middle = (a + b) / Scalar(2);
    const Integral left = integral(a, middle);
    const Integral right = integral(middle, b);
    const Scalar length = left.length + right.length;
    const Linear missing = left.displacement + right.displacement - moved(a, b);
    const Scalar error = std::abs(length - whole.length) + missing.norm();
    if (error <= tolerance || halvings == 0 || cells.t.size() > kMostCells) {
      cells.t.push_back(b);
      cells.s.push_back(cells.s.back() + length);
    } else {
      split(a, middle, left, halvings - 1, tolerance, cells);
      split(middle, b, right, halvings - 1, tolerance, cells);
    }
  }

  Path path_;
};

}  // namespace fpbm
