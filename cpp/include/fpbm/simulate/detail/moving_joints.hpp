#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/moving_ends.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// Velocity and acceleration at the first of seven points with equal distances h, by differences: exact for polynomials
/// of degree 6.
template <int N, typename At>
[[nodiscard]] typename Spline<N>::Rates rates_by_differences(const At& at, double h) {
  constexpr std::array<double, 7> kFirst{-147.0 / 60, 6.0, -15.0 / 2, 20.0 / 3, -15.0 / 4, 6.0 / 5, -1.0 / 6};
  constexpr std::array<double, 7> kSecond{203.0 / 45, -87.0 / 5, 117.0 / 4,  -254.0 / 9,
                                          33.0 / 2,   -27.0 / 5, 137.0 / 180};
  typename Spline<N>::Rates rates = Spline<N>::Rates::Zero(2, at(0).size());
  for (std::size_t i = 0; i < 7; ++i) {
    rates.row(0) += kFirst[i] / h * at(i).transpose();
    rates.row(1) += kSecond[i] / (h * h) * at(i).transpose();
  }
  return rates;
}

/// The joint path q(t) of a path from rest to rest, with the parameter of MovingEnds. The number of intervals is
/// doubled until the positions in the middle of the intervals are within kAccuracy of the spline. Throws
/// std::invalid_argument if this needs too many intervals.
template <int N, typename Path>
[[nodiscard]] Spline<N> moving_joints(const Spline<N>& joints, const MovingEnds<Path>& path) {
  constexpr double kAccuracy = 1e-8;       // [rad] or [m], as of the joint path.
  constexpr double kLeastAccuracy = 1e-7;  // With a larger deviation, the speeds at the ends are not exact to 1e-6.
  constexpr std::size_t kMost = 9600;
  for (std::size_t intervals = joints.times().size() - 1;; intervals *= 2) {
    const double h = path.duration() / static_cast<double>(intervals);
    std::vector<Vector<N>> q;
    std::vector<double> p;
    for (std::size_t i = 0; i <= intervals; ++i) {
      p.push_back(static_cast<double>(i) * h);
      q.push_back(joints.at(path.time(p.back())).x);
    }
    const auto from_start = [&q](std::size_t i) -> const Vector<N>& { return q[i]; };
    const auto from_end = [&q](std::size_t i) -> const Vector<N>& { return q[q.size() - 1 - i]; };
    const typename Spline<N>::Rates rest = Spline<N>::Rates::Zero(2, q[0].size());
    Spline<N> spline(q, p, path.moves(0) ? rates_by_differences<N>(from_start, h) : rest,
                     path.moves(1) ? rates_by_differences<N>(from_end, -h) : rest);
    double deviation = 0.0;
    for (const double each : p) {
      const double middle = std::min(each + h / 2.0, path.duration());
      deviation = std::max(deviation, (spline.at(middle).x - joints.at(path.time(middle)).x).cwiseAbs().maxCoeff());
    }
    if (deviation < kAccuracy || (intervals >= kMost && deviation < kLeastAccuracy)) return spline;
    if (intervals >= kMost) {
      validation::reject("path",
                         ": the joints move too fast for start_speed or end_speed, near a singular posture or in the "
                         "null space: choose another q0, or give no speeds");
    }
  }
}

}  // namespace fpbm
