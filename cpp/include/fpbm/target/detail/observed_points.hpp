#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

#include "fpbm/geometry/detail/chart_rates.hpp"

namespace fpbm {

/// The newest points of a stream of single points. Times are relative to the newest stamp.
template <typename Space, typename Scalar>
class ObservedPoints {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  void clear() noexcept { known_ = 0; }
  [[nodiscard]] bool empty() const noexcept { return known_ == 0; }
  [[nodiscard]] Scalar time() const noexcept { return time_; }  ///< Time of the newest point [s].
  void shift(Scalar seconds) noexcept { time_ -= seconds; }

  /// Adds a point that is newer than the points before.
  void add(Scalar time, const Point& x) noexcept {
    if (known_ > 0) {
      std::copy_backward(h_.begin(), h_.end() - 1, h_.end());
      std::copy_backward(q_.begin(), q_.end() - 1, q_.end());
      h_[0] = time - time_;
      q_[0] = Space::template difference<Scalar>(x, x_) / h_[0];
    }
    known_ = std::min(known_ + 1, h_.size() + 1);
    time_ = time;
    x_ = x;
  }

  /// Longest of the times between the points [s]; 0 for a single point.
  [[nodiscard]] Scalar period() const noexcept {
    return known_ > 1 ? *std::max_element(h_.begin(), h_.begin() + (known_ - 1)) : Scalar(0);
  }

  /// Velocity and acceleration at the newest point, of the polynomial through the last points (Newton's form): four
  /// points, and six points if the points come slowly; for a prediction, three points; fewer points after a gap; zero
  /// for a single point.
  [[nodiscard]] Rates<Twist> rates(bool predicts) const noexcept {
    const auto none = filled<Twist>(Space::kRows);
    if (known_ < 2) return {none, none};
    const std::size_t most = std::min(predicts ? 2 : h_[0] < kSlow ? 3 : h_.size(), known_ - 1);
    std::size_t count = 1;
    while (count < most && h_[count] >= kEven * h_[0]) ++count;
    std::array<Twist, kMemory> q = q_;
    Rates<Twist> rates{q[0], none};
    // First and second derivative, at the newest point, of the product of the differences to the points.
    Scalar distance = h_[0];
    Scalar first = h_[0];
    Scalar second(2);
    for (std::size_t order = 1; order < count; ++order) {
      for (std::size_t k = 0; k + order < count; ++k) {
        const Scalar* from = h_.data() + k;
        q[k] = (q[k] - q[k + 1]) / std::accumulate(from, from + order + 1, Scalar(0));
      }
      rates.xd += first * q[0];
      rates.xdd += second * q[0];
      distance += h_[order];
      second = second * distance + Scalar(2) * first;
      first *= distance;
    }
    return rates;
  }

 private:
  static constexpr std::size_t kMemory = 5;
  /// Time between points from which on six points are used instead of four [s]. Six points multiply the noise of the
  /// points by four in the accelerations. At 10 Hz, this is as much as with four points at 20 Hz.
  static constexpr Scalar kSlow = Scalar(0.1);
  /// Least time between points, relative to the newest, for an extrapolation from the points: a choice. After a gap,
  /// the errors of the points before are multiplied.
  static constexpr Scalar kEven = Scalar(0.25);

  // From the newest to the oldest: times between two points [s], and mean velocities.
  std::array<Scalar, kMemory> h_;
  std::array<Twist, kMemory> q_;
  std::size_t known_ = 0;
  Scalar time_{0};
  Point x_;
};

}  // namespace fpbm
