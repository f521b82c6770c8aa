#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/bound/detail/levers.hpp"
#include "fpbm/limits/detail/stop_part.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// Bounds on the deviation of the torques along a part of a stopping trajectory from the linear interpolation between
/// both ends of the part, for constant accelerations (docs/torques_proof.md, "Between two evaluations").
///
/// Let s_i = √∫‖∂x/∂q_i‖² dm, over all mass points x, and S_i ≥ s_k for k ≥ i. At a posture, s_i² = M_ii without
/// rotors. In a part, s_i increases by at most Σ_{k>i} |Δq_k| S_k. The derivatives of the torques are products of
/// entries of S and of velocities, accelerations and the gravity.
template <int N, typename Scalar = double, int Joints = N>
class TorqueDeviation {
 public:
  using JointVector = Vector<N, Scalar>;
  using Part = StopPart<N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;

  /// source: the Tree or the Chain of the robot. Throws std::invalid_argument if a lever is infinite.
  template <typename Source>
  TorqueDeviation(const Source& source, const Model& model)
      : levers_(source),
        viscous_(filled<JointVector>(model.dof())),
        rotors_(viscous_),
        turning_(model.robot().drives().by_drive(signs(model))),
        follows_(model.robot().drives().follows()) {
    const auto& robot = model.robot();
    for (int link = 1; link <= robot.joints(); ++link) {
      auto unit = filled<AllJoints>(robot.joints());
      unit(link - 1) = Scalar(1);
      const JointVector ratio = robot.drives().by_drive(unit);
      for (Eigen::Index k = 0; k < ratio.size(); ++k) {
        viscous_(k) += ratio(k) * ratio(k) * joint_of(source, link - 1).drive.viscous;
        rotors_(k) += ratio(k) * ratio(k) * joint_of(source, link - 1).drive.rotor_inertia;
      }
      if (model.link(link).mass > Scalar(0) && !is_finite(levers_of(model, link))) {
        reject_unbounded(robot, source, "links", link);
      }
    }
    set(model);
  }

  /// Sets the constants of a model, which may have another payload than before.
  void set(const Model& model) noexcept {
    const auto& robot = model.robot();
    AllJoints squares = filled<AllJoints>(robot.joints());  // s² of the joints, at most.
    AllJoints mass = squares;                               // Mass of the links that a joint moves.
    for (int link = 1; link <= robot.joints(); ++link) {
      const LinkInertia<Scalar>& body = model.link(link);
      if (!(body.mass > Scalar(0))) continue;
      const Scalar moments = body.inertia.coeff(0, 0) + body.inertia.coeff(1, 1) + body.inertia.coeff(2, 2);
      const Scalar gyration = std::sqrt(moments / (Scalar(2) * body.mass));
      const AllJoints levers = levers_of(model, link);
      each_joint(robot.moved_by(link), [&](Eigen::Index i) noexcept {
        const Scalar lever = robot.turns(i) ? levers(i) + gyration : Scalar(1);
        squares(i) += body.mass * lever * lever;
        mass(i) += body.mass;
      });
    }
    const Scalar gravity = norm(model.gravity());
    AllJoints most = squares;
    Scalar largest(0);
    for (Eigen::Index i = most.size() - 1; i >= 0; --i) most(i) = largest = std::max(largest, std::sqrt(squares(i)));
    most_ = robot.drives().by_drive(signed_like(model, most));
    weight_ = robot.drives().by_drive(signed_like(
        model, AllJoints(entrywise(mass, [&](Eigen::Index i) { return gravity * std::sqrt(mass.coeff(i)); }))));
  }

  /// Deviation of each torque [Nm] or [N]. inertia: M at the start of the part. velocity: StopPlan::velocity().
  /// seconds: duration of the part [s].
  [[nodiscard]] JointVector of(const Matrix<N, N, Scalar>& inertia, const Part& part, const JointVector& velocity,
                               Scalar seconds) const noexcept {
    const JointVector S = sizes(inertia, part.speed, seconds);
    const auto most = entrywise(
        S, [&](Eigen::Index i) { return std::max(std::abs(part.low.coeff(i)), std::abs(part.high.coeff(i))); });
    const auto sum = [&](const auto& x) noexcept {
      return sum_over(S, [&](Eigen::Index i) { return S.coeff(i) * x(i); });
    };
    const auto turned = [&](const auto& x) noexcept {
      return sum_over(S, [&](Eigen::Index i) { return turning_.coeff(i) * x(i); });
    };
    const auto speeds = [&](Eigen::Index i) noexcept { return part.speed.coeff(i); };
    const auto accelerations = [&](Eigen::Index i) noexcept { return most.coeff(i); };
    const auto ranges = [&](Eigen::Index i) noexcept { return part.high.coeff(i) - part.low.coeff(i); };
    const Scalar w = turned(speeds);
    Scalar second;  // Factors of S and of the weight.
    Scalar weight;
    if (part.line > Scalar(0)) {
      const Scalar angle = part.line * turned([&](Eigen::Index i) noexcept { return std::abs(velocity.coeff(i)); });
      weight = angle * angle / Scalar(8);
      second =
          weight * (Scalar(12) * sum(accelerations) + Scalar(4) * w * sum(speeds)) + angle / Scalar(2) * sum(ranges);
    } else {
      const Scalar a = turned(accelerations);
      const Scalar eighth = seconds * seconds / Scalar(8);
      weight = eighth * (w * w + a);
      second = eighth * ((Scalar(8) * w * w + Scalar(4) * a) * sum(accelerations) +
                         (Scalar(4) * w * w + Scalar(6) * a) * w * sum(speeds)) +
               seconds / Scalar(4) * (w * sum(ranges) + turned(ranges) * sum(speeds));
    }
    return entrywise(S, [&](Eigen::Index i) {
      return S.coeff(i) * (second + weight * weight_.coeff(i)) + viscous_.coeff(i) * seconds * most.coeff(i);
    });
  }

 private:
  using AllJoints = Vector<Joints, Scalar>;

  /// S in a part that begins with the inertia matrix M.
  [[nodiscard]] JointVector sizes(const Matrix<N, N, Scalar>& M, const JointVector& speed,
                                  Scalar seconds) const noexcept {
    if (follows_) return most_;
    JointVector S = most_;
    Scalar growth(0);
    Scalar largest(0);
    for (Eigen::Index i = S.size() - 1; i >= 0; --i) {
      const Scalar s = std::sqrt(std::max(M.coeff(i, i) - rotors_.coeff(i), Scalar(0)));
      largest = std::max(largest, std::min(s + growth, most_.coeff(i)));
      growth += seconds * speed.coeff(i) * most_.coeff(i);
      S.coeffRef(i) = largest;
    }
    return S;
  }

  /// Levers of the centre of mass of a link, of all joints [m].
  [[nodiscard]] AllJoints levers_of(const Model& model, int link) const noexcept {
    const auto R = transposed(model.robot().in_joint(link, {}).R);
    return levers_(link, times(R, model.link(link).centre));
  }

  /// Signs of the ratios of the joints to their drives.
  [[nodiscard]] static AllJoints signs(const Model& model) noexcept {
    const auto rates = model.robot().drives().rates(filled<JointVector>(model.dof(), Scalar(1)));
    return entrywise(rates, [&](Eigen::Index i) { return std::copysign(Scalar(1), rates.coeff(i)); });
  }
  [[nodiscard]] static AllJoints signed_like(const Model& model, const AllJoints& x) noexcept {
    const AllJoints sign = signs(model);
    return entrywise(x, [&](Eigen::Index i) { return sign.coeff(i) * x.coeff(i); });
  }

  Levers<Scalar> levers_;
  JointVector viscous_;  ///< [Nm s/rad]
  JointVector rotors_;   ///< [kg m²]
  JointVector turning_;  ///< Σ |ratio| over the joints of each drive.
  JointVector most_;     ///< S in any posture [kg½ m].
  JointVector weight_;   ///< Gravity times the root of the mass that each drive moves [kg½ m/s²].
  bool follows_;         ///< Whether joints follow drives.
};

}  // namespace fpbm
