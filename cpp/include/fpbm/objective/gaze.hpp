#pragma once

#include <cmath>

#include "fpbm/core/space.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Direction of an arm's tip as a task of two rows: an arm whose "tip" is the direction a of the tip's z axis, in a
/// planar chart about a desired direction d,
///
///   s = 2 Bᵀa / (1 + dᵀa),   B two unit vectors across d,
///
/// the stereographic projection from −d. s = 0 where a = d; else |s| = 2 tan(θ/2) for an angle θ between a and d [rad],
/// and s̈ + k₁ṡ + k₂s = 0 leads to d from everywhere but −d. The task space is Position<2>, and the arm one with the
/// task space Pose.
template <typename Arm>
class Gaze {
 public:
  using Scalar = typename Arm::Scalar;
  static constexpr int kDof = Arm::kDof;

  /// direction: d, in the base frame; its length does not matter.
  /// Throws std::invalid_argument where it is zero or not finite.
  Gaze(const Arm& arm, const Vector<3, Scalar>& direction) : arm_(arm) {
    using std::sqrt;
    validation::require_finite("direction", direction);
    // Scaled first, so that no square overflows or underflows.
    const Scalar largest = direction.cwiseAbs().maxCoeff();
    if (!(largest > Scalar(0))) validation::fail("direction", 0.0, "longer: it must point somewhere");
    const Vector<3, Scalar> scaled = direction / largest;
    direction_ = scaled / sqrt(scaled.squaredNorm());
    Eigen::Index least = 0;
    direction_.cwiseAbs().minCoeff(&least);
    const Vector<3, Scalar> aside = Vector<3, Scalar>::Unit(least);
    const Vector<3, Scalar> across = cross(direction_, aside);
    const Vector<3, Scalar> first = across / sqrt(across.squaredNorm());
    across_.row(0) = first.transpose();
    across_.row(1) = cross(direction_, first).transpose();
  }

  [[nodiscard]] int dof() const noexcept { return arm_.dof(); }
  [[nodiscard]] const Vector<3, Scalar>& direction() const noexcept { return direction_; }

  /// s and its J at q; does not touch Jd.
  void kinematics(const Vector<kDof, Scalar>& q, Kinematics<Position<2>, kDof, Scalar>& out) const noexcept {
    Kinematics<Pose, kDof, Scalar> pose;
    arm_.kinematics(q, pose);
    const Vector<3, Scalar> a = pose.tip.R.col(2);
    project(a, pose, out);
  }

  /// s, J and Jd at (q, qd).
  void kinematics(const Vector<kDof, Scalar>& q, const Vector<kDof, Scalar>& qd,
                  Kinematics<Position<2>, kDof, Scalar>& out) const noexcept {
    Kinematics<Pose, kDof, Scalar> pose;
    arm_.kinematics(q, qd, pose);
    const Vector<3, Scalar> a = pose.tip.R.col(2);
    const Scalar over = project(a, pose, out);
    const Vector<3, Scalar> omega = pose.J.template bottomRows<3>().lazyProduct(qd);
    const Vector<3, Scalar> ad = cross(omega, a);
    const Vector<2, Scalar> sd = out.J.lazyProduct(qd);
    const Scalar rate = over * direction_.dot(ad);
    // J = over ∂Bᵀa·2 − s over ∂dᵀa, differentiated term by term; over = 1/(1 + dᵀa) changes by −rate over.
    out.Jd.resize(2, q.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const Vector<3, Scalar> w = pose.J.col(j).template tail<3>();
      const Vector<3, Scalar> wd = pose.Jd.col(j).template tail<3>();
      const Vector<3, Scalar> da = cross(w, a);
      const Vector<3, Scalar> dad = cross(wd, a) + cross(w, ad);
      const Vector<2, Scalar> change =
          over * (Scalar(2) * across_.lazyProduct(dad) - sd * direction_.dot(da) - out.tip * direction_.dot(dad));
      out.Jd.col(j) = change - rate * out.J.col(j);
    }
  }

 private:
  /// s and J of a; returns 1/(1 + dᵀa), finite even where a = −d.
  Scalar project(const Vector<3, Scalar>& a, const Kinematics<Pose, kDof, Scalar>& pose,
                 Kinematics<Position<2>, kDof, Scalar>& out) const noexcept {
    const Scalar height = Scalar(1) + direction_.dot(a);
    const Scalar over = Scalar(1) / (height > kLeastHeight ? height : kLeastHeight);
    out.tip = Scalar(2) * over * across_.lazyProduct(a);
    out.J.resize(2, pose.J.cols());
    for (Eigen::Index j = 0; j < pose.J.cols(); ++j) {
      const Vector<3, Scalar> w = pose.J.col(j).template tail<3>();
      const Vector<3, Scalar> da = cross(w, a);
      out.J.col(j) = over * (Scalar(2) * across_.lazyProduct(da) - out.tip * direction_.dot(da));
    }
    return over;
  }

  static constexpr Scalar kLeastHeight = Scalar(1e-6);

  Arm arm_;
  Vector<3, Scalar> direction_;
  Matrix<2, 3, Scalar> across_;  ///< Bᵀ.
};

}  // namespace fpbm
