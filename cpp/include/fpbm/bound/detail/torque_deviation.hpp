#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/bound/detail/levers.hpp"
#include "fpbm/limits/detail/stop_part.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// Bounds on the deviation of the torques along a part of a stopping trajectory from the linear interpolation between
/// both ends of the part, for constant accelerations (docs/torques_proof.md, "Between two evaluations").
///
/// The bounds depend on constants of the robot, valid in every posture: B with |M_ij| ≤ B_ij, and G with |∂g_i/∂θ| ≤
/// G_i if all links turn by θ. They are sums over the links, of mass m and gravity acceleration g:
///
///   B_ij = Σ m ρ_i ρ_j,   G_i = Σ m g ρ_i,   ρ_i ≥ ‖∂x/∂q_i‖ for all points x of the link, as a mean square.
template <int N, typename Scalar = double, int Joints = N>
class TorqueDeviation {
 public:
  using JointVector = Vector<N, Scalar>;
  using Part = StopPart<N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;

  /// source: the Tree or the Chain of the robot. Throws std::invalid_argument if a lever is infinite.
  template <typename Source>
  TorqueDeviation(const Source& source, const Model& model)
      : levers_(source), viscous_(filled<JointVector>(model.dof())) {
    set(model);
    for (Eigen::Index i = 0; i < model.robot().joints(); ++i) {
      auto unit = filled<Vector<Joints, Scalar>>(model.robot().joints());
      unit(i) = Scalar(1);
      const JointVector ratio = model.robot().drives().by_drive(unit);
      for (Eigen::Index k = 0; k < model.dof(); ++k)
        viscous_(k) += ratio(k) * ratio(k) * joint_of(source, i).drive.viscous;
    }
    for (int link = 1; link <= model.robot().joints(); ++link) {
      if (model.link(link).mass > Scalar(0) && !is_finite(levers_of(model, link))) {
        reject_unbounded(model.robot(), source, "links", link);
      }
    }
  }

  /// Sets the constants of a model, which may have another payload than before.
  void set(const Model& model) noexcept {
    const auto& robot = model.robot();
    const Scalar gravity = norm(model.gravity());
    inertia_ = filled<Matrix<N, N, Scalar>>(robot.dof());
    weight_ = filled<JointVector>(robot.dof());
    // A motion by `unit` of a prismatic joint counts as a rotation by 1 rad. Any length is correct, because no lever of
    // a robot with prismatic joints is less.
    const Scalar unit = robot.length() / Scalar(4);
    const auto turning =
        entrywise(levers_of(model, 1), [&](Eigen::Index i) { return robot.turns(i) ? Scalar(1) : Scalar(1) / unit; });
    turning_ = by_drive(robot, turning);
    const bool slides = largest_magnitude(turning) != Scalar(1);
    for (int link = 1; link <= robot.joints(); ++link) {
      const LinkInertia<Scalar>& body = model.link(link);
      if (!(body.mass > Scalar(0))) continue;
      using std::sqrt;
      const Scalar moments = body.inertia.coeff(0, 0) + body.inertia.coeff(1, 1) + body.inertia.coeff(2, 2);
      const Scalar gyration = sqrt(moments / (Scalar(2) * body.mass));
      const auto levers = levers_of(model, link);
      const JointVector lever = by_drive(robot, entrywise(levers, [&](Eigen::Index i) {
                                           if ((robot.moved_by(link) >> i & 1U) == 0) return Scalar(0);
                                           if (!robot.turns(i)) return Scalar(1);
                                           return std::max(levers.coeff(i) + gyration, slides ? unit : Scalar(0));
                                         }));
      for (Eigen::Index i = 0; i < lever.size(); ++i) {
        weight_(i) += body.mass * gravity * lever(i);
        for (Eigen::Index j = 0; j < lever.size(); ++j) inertia_(i, j) += body.mass * lever(i) * lever(j);
      }
    }
  }

  /// Deviation of each torque [Nm] or [N]. velocity: StopPlan::velocity(). seconds: duration of the part [s].
  [[nodiscard]] JointVector of(const Part& part, const JointVector& velocity, Scalar seconds) const noexcept {
    const auto magnitude = [](const JointVector& x) noexcept {
      return entrywise(x, [&](Eigen::Index i) { return std::abs(x.coeff(i)); });
    };
    const JointVector most = entrywise(
        part.low, [&](Eigen::Index i) { return std::max(std::abs(part.low.coeff(i)), std::abs(part.high.coeff(i))); });
    const JointVector range =
        entrywise(part.low, [&](Eigen::Index i) { return part.high.coeff(i) - part.low.coeff(i); });
    const JointVector of_most = product(inertia_, most);
    const JointVector of_speed = product(inertia_, part.speed);
    const JointVector of_range = product(inertia_, range);
    const auto friction = [&](Eigen::Index i) noexcept { return viscous_.coeff(i) * seconds * most.coeff(i); };
    const Scalar w = turned(part.speed);
    if (part.line > Scalar(0)) {
      const Scalar angle = part.line * turned(magnitude(velocity));
      return entrywise(weight_, [&](Eigen::Index i) {
        const Scalar second = Scalar(12) * of_most.coeff(i) + Scalar(4) * w * of_speed.coeff(i) + weight_.coeff(i);
        return angle * angle / Scalar(8) * second + angle / Scalar(2) * of_range.coeff(i) + friction(i);
      });
    }
    const Scalar a = turned(most);
    const Scalar jump = turned(range);
    return entrywise(weight_, [&](Eigen::Index i) {
      const Scalar second = (Scalar(8) * w * w + Scalar(4) * a) * of_most.coeff(i) +
                            (Scalar(4) * w * w + Scalar(6) * a) * w * of_speed.coeff(i) +
                            (w * w + a) * weight_.coeff(i);
      return friction(i) +
             seconds * (seconds / Scalar(8) * second + (w * of_range.coeff(i) + jump * of_speed.coeff(i)) / Scalar(4));
    });
  }

 private:
  /// Angular velocity of any link, at most, if the speeds of the drives are at most `speed` [rad/s].
  [[nodiscard]] Scalar turned(const JointVector& speed) const noexcept {
    return sum_over(speed, [&](Eigen::Index i) { return turning_.coeff(i) * speed.coeff(i); });
  }

  /// Levers of the centre of mass of a link, of all joints [m].
  [[nodiscard]] Vector<Joints, Scalar> levers_of(const Model& model, int link) const noexcept {
    const auto R = transposed(model.robot().in_joint(link, {}).R);
    return levers_(link, times(R, model.link(link).centre));
  }

  /// Σ |ratio| x over the joints of each drive.
  template <typename Robot_>
  [[nodiscard]] static JointVector by_drive(const Robot_& robot, const Vector<Joints, Scalar>& x) noexcept {
    const auto signs = robot.drives().rates(filled<JointVector>(robot.dof(), Scalar(1)));
    return robot.drives().by_drive(
        entrywise(x, [&](Eigen::Index i) { return signs.coeff(i) < Scalar(0) ? -x.coeff(i) : x.coeff(i); }));
  }

  Levers<Scalar> levers_;
  Matrix<N, N, Scalar> inertia_;  ///< B [kg m²]
  JointVector weight_;            ///< G [Nm]
  JointVector viscous_;           ///< [Nm s/rad]
  JointVector turning_;           ///< Angular velocity of the links for a unit speed of each drive, at most.
};

}  // namespace fpbm
