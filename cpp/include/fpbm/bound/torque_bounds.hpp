#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/bound/detail/drive_names.hpp"
#include "fpbm/bound/detail/gravity_gradient.hpp"
#include "fpbm/bound/detail/torque_certificate.hpp"
#include "fpbm/bound/detail/torque_models.hpp"
#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// Bound of a Tracker at acceleration level: |τ_i| ≤ effort_i at the start and at the end of every tick, for the
/// torques τ = M q̈ + h of inverse dynamics (docs/torques.md).
///
/// A tick is accepted only if the torques keep the bounds until the arm is at rest (TorqueCertificate). If a stop with
/// the full deceleration exceeds a bound, a slower stop is planned (slower_stop()). Dry friction is unknown at rest:
/// the bounds on the torque of inverse dynamics are the efforts minus the dry friction.
template <int N, typename Scalar_ = double, int Joints = N>
class TorqueBounds {
 public:
  using Scalar = Scalar_;
  using JointVector = Vector<N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;
  /// Two for each joint. For robots of more joints, the rows are of the first joints, from the base on.
  static constexpr int kRows = N == Eigen::Dynamic || N > 8 ? 16 : 2 * N;
  static constexpr Status kStatus = Status::kSlowed;

  /// source: the Tree or the Chain of the robot. effort: bounds [Nm] or [N], infinite if there is no bound. lighter: if
  /// the mass of the payload is between two values, the model with the smaller mass; the torques of both models, and so
  /// of all models between them, keep the bounds. Throws std::invalid_argument if an effort is not greater than the dry
  /// friction, a drive moves no mass, or a lever is infinite.
  template <typename Source>
  TorqueBounds(const Source& source, const Model& model, const JointVector& effort,
               const std::optional<Model>& lighter = {})
      : models_(model, lighter), effort_(effort), most_(effort), names_(source), certificate_(source, models_) {
    validation::require_size("effort", effort.size(), model.dof());
    require_inertia(source);
    JointVector dry = filled<JointVector>(effort.size());
    for (std::size_t i = 0; i < source.joints.size(); ++i) {
      auto of_joint = filled<Vector<Joints, Scalar>>(model.robot().joints());
      of_joint(static_cast<Eigen::Index>(i)) = joint_of(source, static_cast<Eigen::Index>(i)).drive.dry;
      const JointVector of_drives = model.robot().drives().by_drive(of_joint);
      for (Eigen::Index k = 0; k < dry.size(); ++k) dry(k) += std::abs(of_drives(k));
    }
    for (Eigen::Index i = 0; i < effort.size(); ++i) {
      if (!(effort(i) > dry(i))) {
        validation::fail(validation::element("effort", i), effort(i), "greater than the dry friction of ", names_[i],
                         " = ", dry(i));
      }
      most_(i) -= dry(i);
    }
  }

  [[nodiscard]] bool empty() const noexcept {
    for (Eigen::Index i = 0; i < effort_.size(); ++i) {
      if (std::isfinite(effort_.coeff(i))) return false;
    }
    return true;
  }
  [[nodiscard]] const Model& model() const noexcept { return models_.back(); }
  [[nodiscard]] const JointVector& effort() const noexcept { return effort_; }
  [[nodiscard]] const TorqueModels<Model>& models() const noexcept { return models_; }
  [[nodiscard]] const JointVector& most() const noexcept { return most_; }

  /// Throws std::invalid_argument unless the motion is at acceleration level with bounds on all accelerations.
  template <Level kLevel>
  void require_limits(const Limits<kLevel, N, Scalar>& limits) const {
    if (kLevel == Level::kVelocity) {
      validation::reject("torque bounds",
                         ": must be given with a scheme at acceleration level: at velocity level, the "
                         "torques are unknown");
    }
    for (Eigen::Index i = 0; i < effort_.size(); ++i) {
      if (std::isfinite(limits.bounds().acceleration(i))) continue;
      validation::fail(validation::element("limits.acceleration", i), limits.bounds().acceleration(i),
                       "finite, since torques are bounded");
    }
  }

  /// Throws std::invalid_argument with the joint, the torque and the bound if the arm cannot hold the posture q.
  void require(const JointVector& q) {
    const State<N, Scalar> rest{q, filled<JointVector>(q.size())};
    const auto& torques = certificate_.begin(models_, rest);
    for (std::size_t k = 0; k < models_.size(); ++k) {
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const Scalar torque = std::abs(torques.of[k].h(i));
        if (torque <= most_(i)) continue;
        validation::fail(names_[i] + ": torque at rest", torque, "at most ", most_(i),
                         ": the arm must be able to hold its posture");
      }
    }
  }

  /// Adds rows ±(M u + h)_i ≤ effort_i for joints that could exceed the bound within the bounds on acceleration, at the
  /// start or at the predicted end of the tick.
  template <Level kLevel, int P>
  void rows([[maybe_unused]] const NextMotion<kLevel, N, Scalar>& next,
            [[maybe_unused]] Rows<N, P, Scalar>& rows) noexcept {
    if constexpr (kLevel == Level::kAcceleration) {
      const Scalar h = next.limits.tick();
      const auto& u = next.u;
      const auto& now = certificate_.begin(models_, next.state);
      State<N, Scalar> end = next.state;
      for (Eigen::Index i = 0; i < u.size(); ++i) {
        end.q(i) += h * (end.qd(i) + h / Scalar(2) * u(i));
        end.qd(i) += h * u(i);
      }
      const auto& later = certificate_.ahead(models_, end);
      const Eigen::Index most = rows.count + kRows;
      const JointVector& bound = next.limits.bounds().acceleration;
      for (std::size_t k = 0; k < models_.size(); ++k) {
        for (Eigen::Index i = 0; i < u.size(); ++i) {
          const Scalar reach = std::abs(now.of[k].h(i)) + sum_over(u, [&](Eigen::Index j) {
                                 return std::abs(now.of[k].M.coeff(j, i)) * bound.coeff(j);
                               });
          if (!(reach > kNear * most_(i))) continue;
          const Scalar first = now.of[k].at(i, u);
          const Scalar last = later.of[k].at(i, u);
          for (const Scalar sign : {Scalar(1), Scalar(-1)}) {
            if (rows.count == most) return;
            const auto& torque = (sign * first > sign * last ? now : later).of[k];
            for (Eigen::Index j = 0; j < u.size(); ++j) rows.g(j, rows.count) = sign * torque.M(i, j);
            rows.b(rows.count++) = (Scalar(1) - kSlack) * most_(i) - sign * torque.h(i);
          }
        }
      }
    }
  }

  template <Level kLevel>
  [[nodiscard]] bool accepts([[maybe_unused]] const Limits<kLevel, N, Scalar>& limits,
                             [[maybe_unused]] const State<N, Scalar>& from,
                             [[maybe_unused]] const Stop<kLevel, N, Scalar>& stop) noexcept {
    if constexpr (kLevel == Level::kAcceleration) {
      return certificate_.keeps(models_, most_, limits, from, stop);
    } else {
      return true;
    }
  }

  /// Fraction of the bounds on deceleration for the next attempt after a refused stop with `fraction`, or 0.
  [[nodiscard]] Scalar slower_stop(Scalar fraction) const noexcept {
    const Scalar slower = fraction * std::min(kCautious * certificate_.kept_fraction(), kLeastDecrease);
    return slower > kSlowest ? slower : Scalar(0);
  }

  /// Calls f(gap, gradient) for each joint whose gap 1 − |g_i|/effort_i, the free part of the bound at rest, is below
  /// the range.
  template <typename F>
  void gaps(const JointVector& q, Scalar range, const F& f) noexcept {
    typename Model::State state;
    models_[0].robot().update(q, state);
    for (const Model& model : models_) {
      const JointVector g = model.gravity_torque(state);
      const Matrix<N, N, Scalar> gradient = gravity_gradient(model, state);
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const Scalar gap = Scalar(1) - std::abs(g(i)) / most_(i);
        if (!(gap < range)) continue;
        const Scalar factor = (g(i) > Scalar(0) ? Scalar(-1) : Scalar(1)) / most_(i);
        f(gap, entrywise(g, [&](Eigen::Index j) { return factor * gradient.coeff(i, j); }));
      }
    }
  }

 private:
  /// A joint needs no rows if the torque cannot exceed this fraction of the bound at the start of the tick. The value
  /// is not tuned: within a tick of a Panda, a torque changes by less than 5 % of the bound.
  static constexpr Scalar kNear = Scalar(0.95);
  /// Fraction of the bound that the rows leave, because the end of the tick depends on u: with 0.002, no tick of
  /// 180,000 was refused at its own ends.
  static constexpr Scalar kSlack = Scalar(0.002);
  /// A slower stop has this fraction of the deceleration that would keep the bound, because the stop takes longer and
  /// ends in another posture. With 0.9, ticks of a Panda with 3 kg are refused half as often again as with 0.7.
  static constexpr Scalar kCautious = Scalar(0.7);
  static constexpr Scalar kLeastDecrease = Scalar(0.8);
  /// Slower stops, of less than this fraction of the bounds on deceleration, are not planned. A choice: they would take
  /// 50 times as long as with the full deceleration.
  static constexpr Scalar kSlowest = Scalar(0.02);

  TorqueModels<Model> models_;
  JointVector effort_;
  JointVector most_;  ///< Bounds on the torques of inverse dynamics.
  DriveNames<N> names_;
  TorqueCertificate<N, Scalar, Joints> certificate_;
};

}  // namespace fpbm
