#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "fpbm/bound/detail/field_norms.hpp"
#include "fpbm/bound/detail/levers.hpp"
#include "fpbm/limits/detail/stop_part.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// Bounds on the deviation of the torques along a part of a stopping trajectory from the linear interpolation between
/// both ends of the part, for constant accelerations, and on the difference of the torques in two states
/// (docs/torques_proof.md, "Between two evaluations").
///
/// Let s_i = √∫‖∂x/∂q_i‖² dm, over all mass points x. At a posture, s_i² = M_ii without rotors. In a part, s_i
/// increases by at most Σ |Δq_k| s_k over the joints k beyond i, to S_i at most. The torques and their derivatives are
/// sums of products of S, velocities, accelerations and the gravity.
template <int N, typename Scalar = double, int Joints = N>
class TorqueDeviation {
 public:
  using JointVector = Vector<N, Scalar>;
  using Part = StopPart<N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;

  /// source: the Tree or the Chain of the robot. Throws std::invalid_argument if a lever is infinite.
  template <typename Source>
  TorqueDeviation(const Source& source, const Model& model)
      : drives_(model.robot().drives()),
        viscous_(filled<JointVector>(model.dof())),
        rotors_(viscous_),
        sign_(signs(model)) {
    const auto& robot = model.robot();
    const Levers<Scalar, Joints> of_point(source);
    const auto levers_of = [&](int link) {  // Levers of the centre of mass [m].
      return of_point(link, times(transposed(robot.in_joint(link, {}).R), model.link(link).centre));
    };
    for (int link = 1; link <= robot.joints(); ++link) {
      parents_[static_cast<std::size_t>(link - 1)] = robot.parent(link) - 1;
      tree_ = tree_ || robot.parent(link) != link - 1;
      auto unit = filled<AllJoints>(robot.joints());
      unit(link - 1) = Scalar(1);
      const JointVector ratio = drives_.by_drive(unit);
      for (Eigen::Index k = 0; k < ratio.size(); ++k) {
        viscous_(k) += ratio(k) * ratio(k) * joint_of(source, link - 1).drive.viscous;
        rotors_(k) += ratio(k) * ratio(k) * joint_of(source, link - 1).drive.rotor_inertia;
      }
      if (model.link(link).mass > Scalar(0) && !is_finite(levers_of(link))) {
        reject_unbounded(robot, source, "links", link);
      }
    }
    AllJoints squares = filled<AllJoints>(robot.joints());  // s² of the joints, at most.
    AllJoints mass = squares;                               // Mass of the links that a joint moves.
    for (int link = 1; link <= robot.joints(); ++link) {
      const LinkInertia<Scalar>& body = model.link(link);
      if (!(body.mass > Scalar(0))) continue;
      const Scalar moments = body.inertia.coeff(0, 0) + body.inertia.coeff(1, 1) + body.inertia.coeff(2, 2);
      const Scalar gyration = std::sqrt(moments / (Scalar(2) * body.mass));
      const AllJoints levers = levers_of(link);
      each_joint(robot.moved_by(link), [&](Eigen::Index i) noexcept {
        const Scalar lever = robot.turns(i) ? levers(i) + gyration : Scalar(1);
        squares(i) += body.mass * lever * lever;
        mass(i) += body.mass;
      });
    }
    const Scalar gravity = norm(model.gravity());
    most_ = entrywise(squares, [&](Eigen::Index i) { return std::sqrt(squares.coeff(i)); });
    weight_ = entrywise(mass, [&](Eigen::Index i) { return gravity * std::sqrt(mass.coeff(i)); });
  }

  /// Deviation of each torque [Nm] or [N]. inertia: M in the posture q. start: posture at the start of the part.
  /// velocity: StopPlan::velocity(). seconds: duration of the part [s].
  [[nodiscard]] JointVector of(const Matrix<N, N, Scalar>& inertia, const JointVector& q, const JointVector& start,
                               const Part& part, const JointVector& velocity, Scalar seconds) const noexcept {
    return tree_ ? along<true>(inertia, q, start, part, velocity, seconds)
                 : along<false>(inertia, q, start, part, velocity, seconds);
  }

  /// Bounds on the differences of the torques in two states, for the accelerations of a part [Nm] or [N]. inertia: M in
  /// state x.
  [[nodiscard]] JointVector between(const Matrix<N, N, Scalar>& inertia, const State<N, Scalar>& x,
                                    const State<N, Scalar>& y, const Part& part) const noexcept {
    return tree_ ? near<true>(inertia, x, y, part) : near<false>(inertia, x, y, part);
  }

 private:
  using AllJoints = Vector<Joints, Scalar>;

  template <bool kTree>
  [[nodiscard]] JointVector along(const Matrix<N, N, Scalar>& inertia, const JointVector& q, const JointVector& start,
                                  const Part& part, const JointVector& velocity, Scalar seconds) const noexcept {
    const auto S = norms<kTree>(inertia, [&](Eigen::Index i) noexcept {
      return std::abs(start.coeff(i) - q.coeff(i)) + seconds * part.speed.coeff(i);
    });
    const auto sums = [&](const JointVector& x) noexcept { return S.parents.outward(drives_.rates(x)); };
    const bool line = part.line > Scalar(0);
    const AllJoints a = sums(largest_accelerations(part));
    const AllJoints v = sums(part.speed);
    const AllJoints range = sums(entrywise(q, [&](Eigen::Index i) { return part.high.coeff(i) - part.low.coeff(i); }));
    const AllJoints d = sums(entrywise(
        q, [&](Eigen::Index i) { return line ? part.line * velocity.coeff(i) : seconds * part.speed.coeff(i); }));
    const Scalar square = line ? Scalar(0) : seconds * seconds;
    const Scalar force = S.of(a) + S.of(v, v);
    const Scalar first = Scalar(6) * S.of(a, d) + Scalar(2) * S.of(v, v, d);
    const Scalar second =
        Scalar(6) * S.of(a, d, d) + Scalar(3) * square * S.of(a, a) + S.of(v, v, d, d) + Scalar(4) * S.of(d, range);
    const AllJoints turned = S.with(d);
    const AllJoints twice = S.with(d, d);
    AllJoints deviation = line ? twice : S.with(a);
    for (Eigen::Index i = 0; i < deviation.size(); ++i) {
      const Scalar bent = twice.coeff(i) + square * deviation.coeff(i);
      deviation.coeffRef(i) =
          (bent * (force + weight_.coeff(i)) + turned.coeff(i) * first + S.S.coeff(i) * second) / Scalar(8);
    }
    return by_drive(deviation, [&](Eigen::Index i) noexcept {
      return seconds * std::max(std::abs(part.low.coeff(i)), std::abs(part.high.coeff(i)));
    });
  }

  template <bool kTree>
  [[nodiscard]] JointVector near(const Matrix<N, N, Scalar>& inertia, const State<N, Scalar>& x,
                                 const State<N, Scalar>& y, const Part& part) const noexcept {
    const auto change = [&](Eigen::Index i) noexcept { return std::abs(y.qd.coeff(i) - x.qd.coeff(i)); };
    const auto moved = [&](Eigen::Index i) noexcept { return std::abs(y.q.coeff(i) - x.q.coeff(i)); };
    const auto S = norms<kTree>(inertia, moved);
    const auto sums = [&](const JointVector& each) noexcept { return S.parents.outward(drives_.rates(each)); };
    const AllJoints a = sums(largest_accelerations(part));
    const AllJoints d = sums(entrywise(x.q, moved));
    const AllJoints dv = sums(entrywise(x.q, change));
    const AllJoints v = sums(
        entrywise(x.q, [&](Eigen::Index i) { return std::max(std::abs(x.qd.coeff(i)), std::abs(y.qd.coeff(i))); }));
    const Scalar force = S.of(a) + S.of(v, v);
    const Scalar first = S.of(a, d) + S.of(v, v, d) + Scalar(2) * S.of(v, dv);
    AllJoints difference = S.with(d);
    for (Eigen::Index i = 0; i < difference.size(); ++i) {
      difference.coeffRef(i) = difference.coeff(i) * (force + weight_.coeff(i)) + S.S.coeff(i) * first;
    }
    return by_drive(difference, change);
  }

  /// S within displacements |moved(i)| from a posture with the inertia matrix M.
  template <bool kTree, typename Moved>
  [[nodiscard]] FieldNorms<kTree, Joints, Scalar> norms(const Matrix<N, N, Scalar>& M,
                                                        const Moved& moved) const noexcept {
    const JointParents<kTree, Joints> parents{parents_};
    if (drives_.follows()) return {parents, most_};
    AllJoints S =
        parents.inward(AllJoints(entrywise(most_, [&](Eigen::Index i) { return moved(i) * most_.coeff(i); })));
    for (Eigen::Index i = 0; i < S.size(); ++i) {
      const Scalar s = std::sqrt(std::max(M.coeff(i, i) - rotors_.coeff(i), Scalar(0)));
      S.coeffRef(i) = std::min(s + S.coeff(i), most_.coeff(i));
    }
    return {parents, S};
  }

  [[nodiscard]] static JointVector largest_accelerations(const Part& part) noexcept {
    return entrywise(
        part.low, [&](Eigen::Index i) { return std::max(std::abs(part.low.coeff(i)), std::abs(part.high.coeff(i))); });
  }

  /// Bounds on the torques of the drives, from bounds on the torques of the joints and on changes of the velocities.
  template <typename Change>
  [[nodiscard]] JointVector by_drive(AllJoints& torques, const Change& change) const noexcept {
    for (Eigen::Index i = 0; i < torques.size(); ++i) torques.coeffRef(i) *= sign_.coeff(i);
    JointVector result = drives_.by_drive(torques);
    for (Eigen::Index i = 0; i < result.size(); ++i) result.coeffRef(i) += viscous_.coeff(i) * change(i);
    return result;
  }

  /// Signs of the ratios of the joints to their drives.
  [[nodiscard]] static AllJoints signs(const Model& model) noexcept {
    const auto rates = model.robot().drives().rates(filled<JointVector>(model.dof(), Scalar(1)));
    return entrywise(rates, [&](Eigen::Index i) { return std::copysign(Scalar(1), rates.coeff(i)); });
  }

  Drives<N, Joints, Scalar> drives_;
  std::array<int, static_cast<std::size_t>(kCapacity<Joints>)> parents_{};  ///< Of each joint, −1 on the base.
  bool tree_ = false;                                                       ///< Whether the robot has branches.
  JointVector viscous_;                                                     ///< [Nm s/rad]
  JointVector rotors_;                                                      ///< [kg m²]
  AllJoints sign_;    ///< Signs of the ratios of the joints to their drives.
  AllJoints most_;    ///< S in any posture [kg½ m].
  AllJoints weight_;  ///< Gravity times the root of the mass that each joint moves [kg½ m/s²].
};

}  // namespace fpbm
