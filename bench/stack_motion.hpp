#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "stack_step.hpp"

// A motion of the Panda with a solver: 20 s at 1 kHz. The target of the tip is slow, then faster than the joints, then
// slow near the base, where joints reach the ends of their ranges, then slow again. The target jumps between these
// phases, and by 5 cm within them.
namespace bench::stack {

constexpr int kTicks = 20000;
constexpr double kBack = 0.25;  ///< Displacement of the target toward the base [m].

/// Coordinate, velocity and acceleration of a sine.
struct Wave {
  double size;
  double rate;

  [[nodiscard]] std::array<double, 3> at(double t) const noexcept {
    return {size * std::sin(rate * t), size * rate * std::cos(rate * t), -size * rate * rate * std::sin(rate * t)};
  }
};

/// Targets of all levels at t [s].
template <typename Case>
class Targets {
 public:
  Targets() {
    const fpbm::Robot<N> robot(chain());
    const fpbm::RobotTasks<fpbm::Robot<N>, StackOf<Case>> tasks(robot, Case::stack());
    fpbm::Kinematics<SpaceOf<Case>, N> kinematics;
    tasks.kinematics(kStart, kinematics);
    start_ = kinematics.tip;
  }

  [[nodiscard]] fpbm::Reference<SpaceOf<Case>> operator()(double t) const {
    auto reference = fpbm::Reference<SpaceOf<Case>>::hold(start_);
    const double rate = 5.0 < t && t < 10.0 ? 3.0 : 1.0;
    const double back = 10.0 < t && t < 15.0 ? kBack : 0.0;
    Eigen::Vector3d shift;
    const std::array<Wave, 3> waves{{{0.12, 0.9 * rate}, {0.30, 0.7 * rate}, {0.12, 1.3 * rate}}};
    for (int i = 0; i < 3; ++i) {
      const auto [x, xd, xdd] = waves[static_cast<std::size_t>(i)].at(t);
      shift(i) = x;
      reference.xd(i) = xd;
      reference.xdd(i) = xdd;
    }
    if (std::fmod(t, 3.0) > 1.5) shift(1) += 0.05;
    shift(0) -= back;
    constexpr int M0 = Case::kRows == 6 ? 6 : 3;
    if constexpr (M0 == 6) {
      auto& tip = std::get<0>(reference.x);
      const Eigen::Vector3d axis(0.6, 0.8, 0.0);
      const auto [angle, rotation, change] = Wave{0.4, 1.1 * rate}.at(t);
      tip.p += shift;
      tip.R = Eigen::AngleAxisd(angle, axis).toRotationMatrix() * tip.R;
      reference.xd.template segment<3>(3) = rotation * axis;
      reference.xdd.template segment<3>(3) = change * axis;
    } else {
      std::get<0>(reference.x) += shift;
    }
    const auto [height, speed, change] = Wave{0.04, 0.5}.at(t);
    std::get<1>(reference.x)(2) += height - 0.06;  // Within the workspace of the elbow.
    reference.xd(M0 + 2) = speed;
    reference.xdd(M0 + 2) = change;
    return reference;
  }

 private:
  typename StackOf<Case>::Point start_;
};

/// Largest excess over the bounds, errors of level 0, and the part of level 0 that the bounds remove.
struct Report {
  double position = 0.0;      ///< [rad]
  double velocity = 0.0;      ///< [rad/s]
  double acceleration = 0.0;  ///< By differences of velocities [rad/s²].
  int position_active = 0;
  int velocity_active = 0;
  int acceleration_active = 0;
  int limited = 0;                ///< Ticks in which the law of this library gives a motion outside the box.
  std::vector<double> error;      ///< ‖x ⊖ f(q)‖ of the tip's position [m].
  std::vector<double> residuals;  ///< ‖J₀u − b₀‖ / ‖b₀‖ in limited ticks.
};

template <typename T>
[[nodiscard]] T quantile(std::vector<T> values, double fraction) {
  if (values.empty()) return T(0);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Moves the arm by a solver, and records every tick.
template <typename Case, typename Solver>
Report move(Solver& solver, std::vector<Asked<Case>>& record) {
  const Targets<Case> targets;
  const auto bounds = limits().bounds();
  Ours<Case> ours;
  Report report;
  Asked<Case> asked{{kStart, Joints::Zero()}, Joints::Zero(), {}};
  constexpr double kActive = 1e-6;
  for (int i = 0; i < kTicks; ++i) {
    asked.reference = targets(kTick * i);
    record.push_back(asked);
    Joints u;
    solver(asked, u);
    const bool limited = !ours.is_free(asked);
    const Eigen::VectorXd desired = ours.first_rows() * ours.desired();
    report.error.push_back(fpbm::task_error(ours.kinematics(), asked.reference.x).template head<3>().norm());
    if (limited) {
      ++report.limited;
      report.residuals.push_back((ours.first_rows() * u - desired).norm() / desired.norm());
    }
    auto& [q, qd] = asked.state;
    const Joints before = qd;
    q += kTick * (qd + 0.5 * kTick * u);
    qd += kTick * u;
    asked.last = u;
    const Joints a = (qd - before) / kTick;
    const double past = std::max((q - bounds.upper).maxCoeff(), (bounds.lower - q).maxCoeff());
    const double fast = (qd.cwiseAbs() - bounds.velocity).maxCoeff();
    const double hard = (a.cwiseAbs() - bounds.acceleration).maxCoeff();
    report.position = std::max(report.position, past);
    report.velocity = std::max(report.velocity, fast);
    report.acceleration = std::max(report.acceleration, hard);
    report.position_active += past > -1e-3;
    report.velocity_active += fast > -kActive;
    report.acceleration_active += hard > -kActive;
  }
  return report;
}

}  // namespace bench::stack
