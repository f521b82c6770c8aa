#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/path/detail/tip_bounds.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// Shortest duration to which a path of 1 s must be stretched so that the tip keeps its bounds. Velocities are
/// proportional to 1/duration, accelerations to 1/duration², jerks to 1/duration³.
///
/// The maximum of the required duration over the path (required_duration()) is found by branch and bound. The sample in
/// the middle of an interval, and bounds on the derivatives in the interval, give an upper bound on the required
/// duration of the whole interval. Intervals are halved until this upper bound is at most kSlack times the largest
/// sample. Therefore, the search also finds narrow peaks between samples.
template <typename Space, int M, typename Scalar>
class LeastDuration {
  static constexpr bool kQuaternion = M > Space::kRows;
  static constexpr int kLinear = Space::kRows - Space::kTurns;

 public:
  /// spline: the positions of the path [m], and its angles [rad] or quaternions, which are scaled to unit length.
  LeastDuration(const Spline<M, Scalar>& spline, const TipBounds<Scalar>& bounds) : spline_(spline), bounds_(bounds) {}

  /// Returns a duration between 1/kSlack times the shortest duration and the shortest duration, or 0 if no bound limits
  /// the tip. sample(t) gives the velocity xd and acceleration xdd of the tip.
  template <typename Sample>
  [[nodiscard]] Scalar of(const Sample& sample) const {
    // Samples of each piece of the spline. search() refines the intervals between samples: 16 to 256 pass
    // WaypointsBounds.*.
    constexpr int kSamples = 64;
    const auto& times = spline_.times();
    Scalar longest(0);
    for (std::size_t i = 1; i < times.size(); ++i) {
      for (int k = 0; k < kSamples; ++k) {
        const Scalar fraction = Scalar(k) / Scalar(kSamples);
        const Scalar t = times[i - 1] + fraction * (times[i] - times[i - 1]);
        longest = std::max(longest, required_duration(peaks(sample(t), spline_.derivatives(i - 1, t))));
      }
    }
    if (!(longest > Scalar(0))) return Scalar(0);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
      const Scalar half = (times[i + 1] - times[i]) / Scalar(2 * kSamples);
      for (int k = 0; k < kSamples; ++k) {
        search(sample, i, times[i] + Scalar(2 * k + 1) * half, half, kHalvings, longest);
      }
    }
    return longest;
  }

  /// Waypoints::within() multiplies the result of the search by this slack, so that no bound is exceeded. The path is
  /// then at most 0.5 % slower than the fastest path. WaypointsBounds.* prints the largest difference. With a slack of
  /// 1.0005, poses need 1.7 times the samples.
  static constexpr Scalar kSlack = Scalar(1.005);

 private:
  /// Largest number of halvings, to 1e-8 of a piece, for intervals that may contain |Q| = 0 and have no finite bound. 5
  /// to 40 pass WaypointsBounds.*.
  static constexpr int kHalvings = 20;

  using Derivatives = std::array<Vector<M, Scalar>, 6>;

  /// Norms of velocities, accelerations and jerks.
  template <typename Reference>
  [[nodiscard]] static TipBounds<Scalar> peaks(const Reference& at, const Derivatives& derivatives) {
    constexpr int kTurns = Space::kTurns;
    TipBounds<Scalar> result{at.xd.template head<kLinear>().norm(),          at.xdd.template head<kLinear>().norm(),
                             at.xd.template tail<kTurns>().norm(),           at.xdd.template tail<kTurns>().norm(),
                             derivatives[3].template head<kLinear>().norm(), Scalar(0)};
    if constexpr (kQuaternion) {
      // ω̈ = 2 (vec(Q⃛Q*) + vec(Q̈Q̇*) − (|Q̇|² + Q·Q̈) ω − 2 (Q·Q̇) ω̇)/|Q|², from the derivatives of |Q|² ω = 2 vec(Q̇Q*).
      const auto Q = [&](std::size_t k) { return Vector<4, Scalar>(derivatives[k].template tail<4>()); };
      const Vector<3, Scalar> w = at.xd.template tail<3>();
      const Vector<3, Scalar> wd = at.xdd.template tail<3>();
      const Vector<3, Scalar> sum = vector_of_quotient(Q(3), Q(0)) + vector_of_quotient(Q(2), Q(1)) -
                                    (Q(1).squaredNorm() + Q(0).dot(Q(2))) * w - Scalar(2) * Q(0).dot(Q(1)) * wd;
      result.angular_jerk = Scalar(2) * sum.norm() / Q(0).squaredNorm();
    } else {
      result.angular_jerk = derivatives[3].template tail<kTurns>().norm();
    }
    return result;
  }

  /// Required duration: a path of 1 s with these peaks keeps the bounds if it is stretched to this duration.
  [[nodiscard]] Scalar required_duration(const TipBounds<Scalar>& peak) const {
    return std::max({peak.velocity / bounds_.velocity, peak.angular_velocity / bounds_.angular_velocity,
                     std::sqrt(peak.acceleration / bounds_.acceleration),
                     std::sqrt(peak.angular_acceleration / bounds_.angular_acceleration),
                     std::cbrt(peak.jerk / bounds_.jerk), std::cbrt(peak.angular_jerk / bounds_.angular_jerk)});
  }

  /// Raises `longest` to the largest required duration within `half` [s] of the middle, unless the difference is within
  /// the slack.
  template <typename Sample>
  void search(const Sample& sample, std::size_t i, Scalar middle, Scalar half, int halvings, Scalar& longest) const {
    // Must be below kSlack. Otherwise, an interval with a peak between kSlack and kRaise would be halved kHalvings
    // times. Values from 1 to just below kSlack need the same number of samples.
    constexpr Scalar kRaise = Scalar(1.004);
    const Derivatives derivatives = spline_.derivatives(i, middle);
    const TipBounds<Scalar> here = peaks(sample(middle), derivatives);
    if (required_duration(here) > kRaise * longest) longest = required_duration(here);
    const Scalar bound = required_duration(limits(here, derivatives, half));
    if (halvings == 0 || bound <= kSlack * longest) return;
    search(sample, i, middle - half / Scalar(2), half / Scalar(2), halvings - 1, longest);
    search(sample, i, middle + half / Scalar(2), half / Scalar(2), halvings - 1, longest);
  }

  /// Upper bounds on the derivatives of some rows within `half` [s] of the middle, from their Taylor polynomials.
  class Rows {
   public:
    template <int First, int Count>
    static Rows of(const Derivatives& derivatives, Scalar half) {
      Rows rows;
      for (std::size_t k = 0; k < 6; ++k) rows.norms_[k] = derivatives[k].template segment<Count>(First).norm();
      rows.half_ = half;
      return rows;
    }
    [[nodiscard]] Scalar most(std::size_t k) const {
      Scalar sum(0);
      for (std::size_t j = 6; j-- > k;) sum = norms_[j] + sum * half_ / static_cast<Scalar>(j - k + 1);
      return sum;
    }
    [[nodiscard]] Scalar least_value() const { return Scalar(2) * norms_[0] - most(0); }

   private:
    std::array<Scalar, 6> norms_;
    Scalar half_;
  };

  /// Upper bounds on the peaks within `half` [s] of a middle with the peaks `here`.
  [[nodiscard]] static TipBounds<Scalar> limits(const TipBounds<Scalar>& here, const Derivatives& derivatives,
                                                Scalar half) {
    constexpr Scalar kMost = std::numeric_limits<Scalar>::max();
    const Rows linear = Rows::template of<0, kLinear>(derivatives, half);
    TipBounds<Scalar> result = here;
    result.velocity += half * linear.most(2);
    result.acceleration += half * linear.most(3);
    result.jerk += half * linear.most(4);
    if constexpr (kQuaternion) {
      // Q is the quaternion of the spline, and s = |Q|²: ω = 2 vec(Q̇Q*)/s, ω̇ = 2 (vec(Q̈Q*) − (Q·Q̇) ω)/s. a, b, c
      // and d are bounds on the first four derivatives of Q divided by |Q|; w, wd, wdd and wddd are bounds on ω and its
      // derivatives.
      const Rows turns = Rows::template of<kLinear, M - kLinear>(derivatives, half);
      const Scalar least = std::max(turns.least_value(), Scalar(0));
      const Scalar a = turns.most(1) / least;
      const Scalar b = turns.most(2) / least;
      const Scalar c = turns.most(3) / least;
      const Scalar d = turns.most(4) / least;
      const Scalar w = Scalar(2) * a;
      const Scalar wd = Scalar(2) * (b + a * w);
      const Scalar wdd = Scalar(2) * (c + a * b + (a * a + b) * w + Scalar(2) * a * wd);
      const Scalar wddd =
          Scalar(2) * (d + Scalar(2) * a * c + (Scalar(3) * a * b + c) * w + Scalar(3) * ((a * a + b) * wd + a * wdd));
      result.angular_velocity += half * wd;
      result.angular_acceleration += half * wdd;
      result.angular_jerk += half * wddd;
    } else if constexpr (Space::kTurns > 0) {
      const Rows turns = Rows::template of<kLinear, M - kLinear>(derivatives, half);
      result.angular_velocity += half * turns.most(2);
      result.angular_acceleration += half * turns.most(3);
      result.angular_jerk += half * turns.most(4);
    }
    // Infinity is replaced, since |Q| may be zero: required_duration() would divide infinity by an infinite bound.
    if (!(result.angular_velocity <= kMost)) result.angular_velocity = kMost;
    if (!(result.angular_acceleration <= kMost)) result.angular_acceleration = kMost;
    if (!(result.angular_jerk <= kMost)) result.angular_jerk = kMost;
    return result;
  }

  const Spline<M, Scalar>& spline_;
  TipBounds<Scalar> bounds_;
};

}  // namespace fpbm
