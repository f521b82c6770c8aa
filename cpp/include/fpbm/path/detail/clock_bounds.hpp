#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "fpbm/path/detail/clock_torques.hpp"

namespace fpbm {

/// State of a clock p(t) at one place p of a path: y = ṗ², and the derivatives of y with respect to p. The rates of the
/// clock are p̈ = y′/2 and p⃛ = √y y″/2.
struct ClockState {
  double y;
  double y1;
  double y2;
};

/// The bounds on a motion along a joint path q(p) at one place of the path, as bounds on the clock:
///   q̇ = q′√y,  q̈ = q″y + q′y′/2,  q⃛ = √y (q‴y + 3q″y′/2 + q′y″/2),
/// each divided by its bound. Torques are M q̈ + h, with the terms of a ClockTorque. Bounds on the tip, ẋ = x′√y and ẍ =
/// x″y + x′y′/2, are bounds on norms.
class ClockBounds {
 public:
  /// d: q′, q″, q‴. v, a, j: bounds on velocities, accelerations and jerks; j may be infinite.
  template <typename JointVector, typename Derivatives>
  ClockBounds(const Derivatives& d, const JointVector& v, const JointVector& a, const JointVector& j)
      : joints_(static_cast<std::size_t>(v.size())) {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      speed_ = std::max(speed_, d[0](k) * d[0](k) / (v(k) * v(k)));
      joints_[i] = {d[1](k) / a(k), d[0](k) / (2.0 * a(k)), d[2](k) / j(k), 1.5 * d[1](k) / j(k),
                    d[0](k) / (2.0 * j(k))};
    }
  }

  /// Adds a bound on a speed. ratio: the speed divided by its bound, if ṗ = 1.
  void add_speed(double ratio) { speed_ = std::max(speed_, ratio * ratio); }

  /// Adds bounds on the speed and the acceleration of the tip, whose position has the derivatives d1 and d2.
  template <typename Position>
  void add_tip(const Position& d1, const Position& d2, double speed, double acceleration) {
    add_speed(d1.norm() / speed);
    const double square = acceleration * acceleration;
    tip_ = {d2.squaredNorm() / square, d2.dot(d1) / (2.0 * square), d1.squaredNorm() / (4.0 * square)};
  }

  /// Adds bounds on torques, which the motion has for ṗ = 1. The torques at rest are within their bounds.
  void add_torques(std::vector<ClockTorque> torques) { torques_ = std::move(torques); }

  /// Number of bounds.
  [[nodiscard]] std::size_t count() const noexcept { return 2 + 4 * joints_.size() + 2 * torques_.size(); }

  /// The largest y of a clock with constant rate.
  [[nodiscard]] double largest() const noexcept {
    double inverse = std::max(speed_, std::sqrt(tip_[0]));
    for (const Joint& joint : joints_) {
      inverse = std::max({inverse, std::abs(joint.a0), std::cbrt(joint.j0 * joint.j0)});
    }
    for (const ClockTorque& torque : torques_) {  // Also with other signs, so that all smaller y keep the bounds.
      const double slower =
          ClockTorque{std::abs(torque.rest), std::abs(torque.odd), std::abs(torque.even), 0.0}.slower();
      inverse = std::max(inverse, slower * slower);
    }
    return 1.0 / inverse;
  }

  /// The largest y within the bounds on velocities.
  [[nodiscard]] double largest_for_speeds() const noexcept { return 1.0 / speed_; }
  /// Removes the bounds on velocities, where y is given.
  void remove_speeds() noexcept { speed_ = 0.0; }

  /// Changes the unit of y: the new y is y divided by `unit`. At places where the path stands, y is at most kMostY.
  void scale(double unit) noexcept {
    constexpr double kMostY = 1e8;
    speed_ = std::max(speed_ * unit, 1.0 / kMostY);
    for (double& entry : tip_) entry *= unit * unit;
    const double cubic = unit * std::sqrt(unit);
    for (Joint& joint : joints_) {
      joint = {unit * joint.a0, unit * joint.a1, cubic * joint.j0, cubic * joint.j1, cubic * joint.j2};
    }
    for (ClockTorque& torque : torques_) {
      torque = {torque.rest, std::sqrt(unit) * torque.odd, unit * torque.even, unit * torque.change};
    }
  }

  /// Sum of −log(1 − r²) over the ratios r of all bounded quantities to their bounds; infinite if a bound is exceeded.
  [[nodiscard]] double barrier(const ClockState& at) const noexcept {
    if (!(at.y > 0.0)) return std::numeric_limits<double>::infinity();
    double product = slack(speed_ * at.y) * slack(tip_square(at));
    for (const Joint& joint : joints_) {
      const double a = joint.acceleration(at);
      const double j = joint.jerk(at);
      product *= slack(a * a) * slack(at.y * j * j);
    }
    for (const ClockTorque& torque : torques_) {
      const double ratio = torque_at(torque, at).ratio();
      product *= slack(ratio * ratio);
    }
    return product > 0.0 ? -std::log(product) : std::numeric_limits<double>::infinity();
  }

  /// Adds the gradient of barrier() with respect to (y, y′, y″), and its Hessian (upper triangle, by rows), without the
  /// second derivatives of the jerks, so that the Hessian is positive semidefinite.
  void add_derivatives(const ClockState& at, std::array<double, 3>& gradient,
                       std::array<double, 6>& hessian) const noexcept {
    const auto add = [&](double c1, double c2, double u0, double u1, double u2) {
      gradient[0] += c1 * u0;
      gradient[1] += c1 * u1;
      gradient[2] += c1 * u2;
      hessian[0] += c2 * u0 * u0;
      hessian[1] += c2 * u0 * u1;
      hessian[2] += c2 * u0 * u2;
      hessian[3] += c2 * u1 * u1;
      hessian[4] += c2 * u1 * u2;
      hessian[5] += c2 * u2 * u2;
    };
    const double speed = 1.0 / (1.0 - speed_ * at.y);
    add(speed, speed * speed, speed_, 0.0, 0.0);
    const double tip = 1.0 / (1.0 - tip_square(at));
    add(tip, tip * tip, 2.0 * (tip_[0] * at.y + tip_[1] * at.y1), 2.0 * (tip_[1] * at.y + tip_[2] * at.y1), 0.0);
    hessian[0] += 2.0 * tip * tip_[0];
    hessian[1] += 2.0 * tip * tip_[1];
    hessian[3] += 2.0 * tip * tip_[2];
    const auto add_ratio = [&](double ratio, double u0, double u1, double u2) {
      const double inverse = 1.0 / (1.0 - ratio * ratio);
      add(2.0 * ratio * inverse, 2.0 * (1.0 + ratio * ratio) * inverse * inverse, u0, u1, u2);
    };
    const double root = std::sqrt(at.y);
    for (const Joint& joint : joints_) {
      add_ratio(joint.acceleration(at), joint.a0, joint.a1, 0.0);
      const double j = joint.jerk(at);
      add_ratio(root * j, root * joint.j0 + j / (2.0 * root), root * joint.j1, root * joint.j2);
    }
    for (const ClockTorque& torque : torques_) {
      add_ratio(torque_at(torque, at).ratio(), torque.even + torque.odd / (2.0 * root), torque.change / 2.0, 0.0);
    }
  }

  /// The factor by which a clock must be slower everywhere, so that no bound is exceeded here.
  [[nodiscard]] double slower(const ClockState& at) const noexcept {
    const double root = std::sqrt(std::max(at.y, 0.0));
    double a = std::sqrt(std::max(tip_square(at), 0.0));
    double j = 0.0;
    for (const Joint& joint : joints_) {
      a = std::max(a, std::abs(joint.acceleration(at)));
      j = std::max(j, root * std::abs(joint.jerk(at)));
    }
    double slower = std::max({std::sqrt(speed_) * root, std::sqrt(a), std::cbrt(j)});
    for (const ClockTorque& torque : torques_) slower = std::max(slower, torque_at(torque, at).slower());
    return slower;
  }

 private:
  /// Coefficients of the acceleration and the jerk of a joint, divided by their bounds.
  struct Joint {
    double a0, a1, j0, j1, j2;

    [[nodiscard]] double acceleration(const ClockState& at) const noexcept { return a0 * at.y + a1 * at.y1; }
    /// Divided by √y.
    [[nodiscard]] double jerk(const ClockState& at) const noexcept { return j0 * at.y + j1 * at.y1 + j2 * at.y2; }
  };

  [[nodiscard]] static ClockTorque torque_at(const ClockTorque& torque, const ClockState& at) noexcept {
    return {torque.rest, torque.odd * std::sqrt(std::max(at.y, 0.0)), torque.even * at.y + torque.change * at.y1 / 2.0,
            torque.change};
  }

  static double slack(double square) noexcept { return std::max(1.0 - square, 0.0); }
  [[nodiscard]] double tip_square(const ClockState& at) const noexcept {
    return tip_[0] * at.y * at.y + 2.0 * tip_[1] * at.y * at.y1 + tip_[2] * at.y1 * at.y1;
  }

  std::vector<Joint> joints_;
  std::vector<ClockTorque> torques_;
  std::array<double, 3> tip_{};  ///< Quadratic form of the acceleration of the tip in y and y′.
  double speed_ = 0.0;           ///< Largest square of a velocity divided by its bound, at y = 1.
};

}  // namespace fpbm
