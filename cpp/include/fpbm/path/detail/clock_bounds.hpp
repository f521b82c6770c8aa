#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace fpbm {

/// State of a clock p(t) at one place p of a path: x = ṗ², and the derivatives of x with respect to p. The rates of the
/// clock are p̈ = x′/2 and p⃛ = √x x″/2.
struct ClockState {
  double x;
  double x1;
  double x2;
};

/// The bounds on a motion along a joint path q(p) at one place of the path, as bounds on the clock:
///   q̇ = q′√x,  q̈ = q″x + q′x′/2,  q⃛ = √x (q‴x + 3q″x′/2 + q′x″/2),
/// each divided by its bound. Bounds on the tip, ẋ = x′√x and ẍ = x″x + x′x′/2 (x′: derivatives of the position of the
/// tip), are bounds on norms.
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

  /// The largest x of a clock with constant rate.
  [[nodiscard]] double largest() const noexcept {
    double inverse = std::max(speed_, std::sqrt(tip_[0]));
    for (const Joint& joint : joints_) {
      inverse = std::max({inverse, std::abs(joint.a0), std::cbrt(joint.j0 * joint.j0)});
    }
    return 1.0 / inverse;
  }

  /// Changes the unit of x: the new x is x divided by `unit`. At places where the path stands, x is at most kMostX.
  void scale(double unit) noexcept {
    constexpr double kMostX = 1e8;
    speed_ = std::max(speed_ * unit, 1.0 / kMostX);
    for (double& entry : tip_) entry *= unit * unit;
    const double cubic = unit * std::sqrt(unit);
    for (Joint& joint : joints_) {
      joint = {unit * joint.a0, unit * joint.a1, cubic * joint.j0, cubic * joint.j1, cubic * joint.j2};
    }
  }

  /// Sum of −log(1 − r²) over the ratios r of all bounded quantities to their bounds; infinite if a bound is exceeded.
  [[nodiscard]] double barrier(const ClockState& at) const noexcept {
    if (!(at.x > 0.0)) return std::numeric_limits<double>::infinity();
    double product = slack(speed_ * at.x) * slack(tip_square(at));
    for (const Joint& joint : joints_) {
      const double a = joint.acceleration(at);
      const double j = joint.jerk(at);
      product *= slack(a * a) * slack(at.x * j * j);
    }
    return product > 0.0 ? -std::log(product) : std::numeric_limits<double>::infinity();
  }

  /// Adds the gradient of barrier() with respect to (x, x′, x″), and its Hessian (upper triangle, by rows), without the
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
    const double speed = 1.0 / (1.0 - speed_ * at.x);
    add(speed, speed * speed, speed_, 0.0, 0.0);
    const double tip = 1.0 / (1.0 - tip_square(at));
    add(tip, tip * tip, 2.0 * (tip_[0] * at.x + tip_[1] * at.x1), 2.0 * (tip_[1] * at.x + tip_[2] * at.x1), 0.0);
    hessian[0] += 2.0 * tip * tip_[0];
    hessian[1] += 2.0 * tip * tip_[1];
    hessian[3] += 2.0 * tip * tip_[2];
    const auto add_ratio = [&](double ratio, double u0, double u1, double u2) {
      const double inverse = 1.0 / (1.0 - ratio * ratio);
      add(2.0 * ratio * inverse, 2.0 * (1.0 + ratio * ratio) * inverse * inverse, u0, u1, u2);
    };
    const double root = std::sqrt(at.x);
    for (const Joint& joint : joints_) {
      add_ratio(joint.acceleration(at), joint.a0, joint.a1, 0.0);
      const double j = joint.jerk(at);
      add_ratio(root * j, root * joint.j0 + j / (2.0 * root), root * joint.j1, root * joint.j2);
    }
  }

  /// The factor by which a clock must be slower everywhere, so that no bound is exceeded here.
  [[nodiscard]] double slower(const ClockState& at) const noexcept {
    const double root = std::sqrt(std::max(at.x, 0.0));
    double a = std::sqrt(std::max(tip_square(at), 0.0));
    double j = 0.0;
    for (const Joint& joint : joints_) {
      a = std::max(a, std::abs(joint.acceleration(at)));
      j = std::max(j, root * std::abs(joint.jerk(at)));
    }
    return std::max({std::sqrt(speed_) * root, std::sqrt(a), std::cbrt(j)});
  }

 private:
  /// Coefficients of the acceleration and the jerk of a joint, divided by their bounds.
  struct Joint {
    double a0, a1, j0, j1, j2;

    [[nodiscard]] double acceleration(const ClockState& at) const noexcept { return a0 * at.x + a1 * at.x1; }
    /// Divided by √x.
    [[nodiscard]] double jerk(const ClockState& at) const noexcept { return j0 * at.x + j1 * at.x1 + j2 * at.x2; }
  };

  static double slack(double square) noexcept { return std::max(1.0 - square, 0.0); }
  [[nodiscard]] double tip_square(const ClockState& at) const noexcept {
    return tip_[0] * at.x * at.x + 2.0 * tip_[1] * at.x * at.x1 + tip_[2] * at.x1 * at.x1;
  }

  std::vector<Joint> joints_;
  std::array<double, 3> tip_{};  ///< Quadratic form of the acceleration of the tip in x and x′.
  double speed_ = 0.0;           ///< Largest square of a velocity divided by its bound, at x = 1.
};

}  // namespace fpbm
