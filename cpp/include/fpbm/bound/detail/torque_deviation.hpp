#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/bound/detail/levers.hpp"
#include "fpbm/limits/detail/stop_part.hpp"
#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// Bounds on the deviation of the torques of a motion from the linear interpolation between the two ends of the motion
/// (docs/torques.md, "Between two evaluations").
///
/// They depend on constants of the robot, valid in every posture: |M_ij| ≤ inertia(i, j) and |∂g_i/∂θ| ≤ weight(i) for
/// a rotation by θ.
template <int N, typename Scalar = double, int Joints = N>
class TorqueDeviation {
 public:
  using JointVector = Vector<N, Scalar>;
  using Part = StopPart<N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;

  /// source: the Tree or the Chain of the robot.
  template <typename Source>
  explicit TorqueDeviation(const Source& source, const Model& model) : levers_(source) {
    set(model);
  }

  /// Sets the constants, for example after a change of the payload.
  void set(const Model& model) noexcept {
    const auto& robot = model.robot();
    const Eigen::Index n = robot.dof();
    const Eigen::Index joints = robot.joints();
    inertia_ = filled<Matrix<N, N, Scalar>>(n);
    weight_ = filled<JointVector>(n);
    // Unit of length with which prismatic joints count as rotations.
    const Scalar unit = robot.length() / Scalar(4);
    bool slides = false;
    for (Eigen::Index i = 0; i < joints; ++i) slides = slides || !robot.turns(i);
    const Vector<Joints, Scalar> ones = filled<Vector<Joints, Scalar>>(joints, Scalar(1));
    Vector<Joints, Scalar> turning = ones;
    for (Eigen::Index i = 0; i < joints; ++i) turning(i) = robot.turns(i) ? Scalar(1) : Scalar(1) / unit;
    angle_ = filled<JointVector>(n);
    each_ratio(robot, [&](Eigen::Index i, Eigen::Index drive, Scalar ratio) { angle_(drive) += ratio * turning(i); });
    for (int link = 1; link <= joints; ++link) {
      const LinkInertia<Scalar>& body = model.link(link);
      if (!(body.mass > Scalar(0))) continue;
      using std::sqrt;
      const Scalar gyration = sqrt(std::max(body.inertia.trace(), Scalar(0)) / (Scalar(2) * body.mass));
      const auto lever = levers_(link, times(transposed(robot.in_joint(link, {}).R), body.centre));
      JointVector reach = filled<JointVector>(n);
      each_ratio(robot, [&](Eigen::Index i, Eigen::Index drive, Scalar ratio) {
        if ((robot.moved_by(link) >> i & 1U) == 0) return;
        Scalar own = robot.turns(i) ? lever(i) + gyration : Scalar(1);
        if (slides && robot.turns(i)) own = std::max(own, unit);
        reach(drive) += ratio * own;
      });
      const Scalar gravity = norm(model.gravity());
      for (Eigen::Index i = 0; i < n; ++i) {
        weight_(i) += body.mass * gravity * reach(i);
        for (Eigen::Index j = 0; j < n; ++j) inertia_(i, j) += body.mass * reach(i) * reach(j);
      }
    }
  }

  /// Deviation of each torque in a part of a stop of `seconds` [s].
  [[nodiscard]] JointVector of(const Part& part, Scalar seconds) const noexcept {
    const Eigen::Index n = part.low.size();
    const JointVector most = entrywise(
        part.low, [&](Eigen::Index i) { return std::max(std::abs(part.low.coeff(i)), std::abs(part.high.coeff(i))); });
    const JointVector range = part.high - part.low;
    const Scalar w = angle_.dot(part.speed);
    const JointVector of_most = inertia_ * most;
    const JointVector of_speed = inertia_ * part.speed;
    const JointVector of_range = inertia_ * range;
    if (part.along > Scalar(0)) {
      const Scalar angle = part.turned;
      return entrywise(weight_, [&](Eigen::Index i) {
        return angle * angle / Scalar(8) *
                   (Scalar(12) * of_most.coeff(i) + Scalar(4) * w * of_speed.coeff(i) + weight_.coeff(i)) +
               angle / Scalar(2) * of_range.coeff(i);
      });
    }
    const Scalar a = angle_.dot(most);
    const Scalar change = angle_.dot(range);
    const Scalar t = seconds;
    (void)n;
    return entrywise(weight_, [&](Eigen::Index i) {
      return t * t / Scalar(8) *
                 ((Scalar(8) * w * w + Scalar(4) * a) * of_most.coeff(i) +
                  (Scalar(4) * w * w * w + Scalar(6) * w * a) * of_speed.coeff(i) +
                  (w * w + a) * weight_.coeff(i)) +
             t / Scalar(4) * (w * of_range.coeff(i) + change * of_speed.coeff(i));
    });
  }

  /// Angle by which a motion along `velocity` for `seconds` turns the links at most [rad].
  [[nodiscard]] Scalar turned(const JointVector& velocity, Scalar seconds) const noexcept {
    return seconds * sum_over(velocity, [&](Eigen::Index i) { return angle_.coeff(i) * std::abs(velocity.coeff(i)); });
  }

  /// Throws if a constant is infinite.
  [[nodiscard]] bool finite() const noexcept { return is_finite(weight_) && is_finite(JointVector(inertia_.diagonal())); }

 private:
  template <typename Robot_, typename F>
  static void each_ratio(const Robot_& robot, const F& f) noexcept {
    const Eigen::Index n = robot.dof();
    for (Eigen::Index drive = 0; drive < n; ++drive) {
      JointVector unit = filled<JointVector>(n);
      unit(drive) = Scalar(1);
      const auto rates = robot.drives().rates(unit);
      for (Eigen::Index i = 0; i < rates.size(); ++i) {
        if (rates(i) != Scalar(0)) f(i, drive, std::abs(rates(i)));
      }
    }
  }

  Levers<Scalar> levers_;
  Matrix<N, N, Scalar> inertia_;  ///< [kg m²]
  JointVector weight_;            ///< [Nm]
  JointVector angle_;             ///< Rotation of all links for a velocity of a drive, at most [rad/rad] or [rad/m].
};

}  // namespace fpbm
