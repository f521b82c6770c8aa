#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/path/detail/least_duration.hpp"
#include "fpbm/path/detail/point.hpp"
#include "fpbm/path/detail/tip_bounds.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// Smooth path through points of a task space, from rest to rest, with continuous acceleration.
///
/// Positions are on a quintic spline. Orientations are on a quintic spline of quaternions, scaled to unit length; the
/// angular velocity and its derivative are exact. Only differences from the first point matter, since a path is a
/// displacement from the start position of the tip. Between two orientations, the path rotates by the smaller angle.
template <typename Space_, typename Scalar_ = double>
class Waypoints {
 public:
  using Scalar = Scalar_;
  using Space = Space_;
  using Point = typename Space::template Point<Scalar>;

  /// Path that passes points[i] at times[i] [s], with times[0] = 0.
  /// Throws std::invalid_argument unless there are as many times as points, at least two, the times increase strictly,
  /// and all numbers are finite.
  Waypoints(const std::vector<Point>& points, const std::vector<Scalar>& times)
      : spline_(rows(points), required(times, points.size())) {}

  /// Path with a duration [s] that is divided among the pieces in proportion to their lengths and angles. Throws
  /// std::invalid_argument if duration is not positive and finite, there are fewer than two points, or two successive
  /// points are equal.
  [[nodiscard]] static Waypoints lasting(const std::vector<Point>& points, Scalar duration) {
    validation::require_positive("duration", duration);
    std::vector<Scalar> times = time_fractions(points);
    for (Scalar& time : times) time *= duration;
    times.back() = duration;
    return Waypoints(points, times);
  }

  /// Fastest path within the bounds, which are never exceeded. The duration is at most 0.5 % longer than the shortest
  /// duration. The result is then rounded up to a multiple of 0.01 s, so that usual steps divide the duration. The
  /// duration is divided among the pieces as in lasting(). Throws std::invalid_argument under the conditions of
  /// lasting(), and if no bound limits the tip.
  [[nodiscard]] static Waypoints within(const std::vector<Point>& points, const TipBounds<Scalar>& bounds) {
    require_bound("velocity", bounds.velocity);
    require_bound("acceleration", bounds.acceleration);
    require_bound("angular_velocity", bounds.angular_velocity);
    require_bound("angular_acceleration", bounds.angular_acceleration);
    require_bound("jerk", bounds.jerk);
    require_bound("angular_jerk", bounds.angular_jerk);
    const Waypoints unit = lasting(points, Scalar(1));
    const Scalar duration = LeastDuration<Space, kCoordinates, Scalar>(unit.spline_, bounds).of([&unit](Scalar t) {
      return unit.sample(t);
    });
    if (!(duration > Scalar(0))) {
      validation::reject("bounds",
                         ": at least one bound must limit the tip: give a bound on velocity, acceleration or jerk");
    }
    return lasting(points, std::ceil(Scalar(100.5) * duration) / Scalar(100));
  }

  [[nodiscard]] Scalar duration() const noexcept { return spline_.times().back(); }

  /// Reference at t [s], as a displacement from the first point. Outside of 0 ≤ t ≤ T, at rest at the nearest end.
  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept {
    const auto at = spline_.at(t);
    if constexpr (!kTurns) {
      return {at.x, at.xd, at.xdd};
    } else {
      using Quaternion = Vector<4, Scalar>;
      const Quaternion Q = at.x.template tail<4>();
      const Quaternion Qd = at.xd.template tail<4>();
      const Quaternion Qdd = at.xdd.template tail<4>();
      // The orientation is q = Q/|Q|, and ω = 2 vec(q̇q*). Since vec(QQ*) = 0, the component of Q̇ along Q has no
      // effect on the vector part: ω = 2 vec(Q̇Q*)/|Q|². The derivative is ω̇ = 2 (vec(Q̈Q*) − (Q·Q̇) ω)/|Q|².
      const Scalar square = Q.squaredNorm();
      const Vector<3, Scalar> w = Scalar(2) / square * vector_of_quotient(Qd, Q);
      Reference<Space, Scalar> result;
      result.x = {at.x.template head<3>(), rotation(Quaternion(Q / std::sqrt(square)))};
      result.xd << at.xd.template head<3>(), w;
      result.xdd << at.xdd.template head<3>(), Scalar(2) / square * (vector_of_quotient(Qdd, Q) - Q.dot(Qd) * w);
      return result;
    }
  }

 private:
  static constexpr bool kTurns = std::is_same_v<Space, Pose>;
  static constexpr int kLinear = Space::kRows == 2 || std::is_same_v<Space, PlanarPose> ? 2 : 3;
  static constexpr int kCoordinates = kTurns ? 7 : Space::kRows;
  using Coordinates = Vector<kCoordinates, Scalar>;

  /// Points of the spline: displacements from the first point. The sign of each quaternion is chosen for the smaller
  /// angle from the previous quaternion.
  static std::vector<Coordinates> rows(const std::vector<Point>& points) {
    require_points<Space, Scalar>(points);
    std::vector<Coordinates> result(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if constexpr (kTurns) {
        const Matrix<3, 3, Scalar> rotated = points[i].R * points[0].R.transpose();
        Vector<4, Scalar> q = quaternion(rotated);
        if (i > 0 && q.dot(result[i - 1].template tail<4>()) < Scalar(0)) q = -q;
        result[i] << points[i].p - points[0].p, q;
      } else if (i == 0) {
        result[i].setZero();
      } else {
        result[i] = result[i - 1] + Space::template difference<Scalar>(points[i], points[i - 1]);
      }
    }
    return result;
  }

  static const std::vector<Scalar>& required(const std::vector<Scalar>& times, std::size_t points) {
    if (times.size() != points) {
      validation::reject("times", " has ", times.size(), " entries: must have ", points, ", one per point");
    }
    if (times[0] != Scalar(0)) validation::fail("times[0]", times[0], "0");
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (!(times[i] > times[i - 1]) || !std::isfinite(times[i])) {
        validation::fail(validation::element("times", static_cast<Eigen::Index>(i)), times[i],
                         "finite and later than the previous time");
      }
    }
    return times;
  }

  static void require_bound(const char* name, Scalar bound) {
    if (!(bound > Scalar(0))) validation::fail(name, bound, "positive");
  }

  /// Time of each point as a fraction of the duration.
  static std::vector<Scalar> time_fractions(const std::vector<Point>& points) {
    require_points<Space, Scalar>(points);
    std::vector<Scalar> lengths(points.size(), Scalar(0));
    std::vector<Scalar> angles(points.size(), Scalar(0));
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vector<Space::kRows, Scalar> displacement = Space::template difference<Scalar>(points[i], points[i - 1]);
      lengths[i] = displacement.template head<kLinear>().norm();
      angles[i] = displacement.template tail<Space::kRows - kLinear>().norm();
      if (!(lengths[i] + angles[i] > Scalar(0))) {
        validation::reject(validation::element("points", static_cast<Eigen::Index>(i)),
                           ": must differ from the previous point");
      }
    }
    const Scalar length = std::accumulate(lengths.begin(), lengths.end(), Scalar(0));
    const Scalar angle = std::accumulate(angles.begin(), angles.end(), Scalar(0));
    std::vector<Scalar> times(points.size(), Scalar(0));
    for (std::size_t i = 1; i < points.size(); ++i) {
      times[i] = times[i - 1] + (length > Scalar(0) ? lengths[i] / length : Scalar(0)) +
                 (angle > Scalar(0) ? angles[i] / angle : Scalar(0));
    }
    const Scalar whole = times.back();
    for (Scalar& time : times) time /= whole;
    return times;
  }

  Spline<kCoordinates, Scalar> spline_;
};

}  // namespace fpbm
