#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "fpbm/core/validation.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/model/serial_arm.hpp"

namespace fpbm {

/// A serial chain in which some joints follow others (gears, belts, URDF's mimic): N joints have drives of their own,
/// any number follow. Immutable.
///
/// Chain positions are A q + b with a constant A, so that J = J_chain A and Jd = Jd_chain A.
template <int N, typename Scalar_ = double>
class CoupledArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// A joint whose mimic names another joint follows that one, which must have a drive of its own.
  /// Throws std::invalid_argument where the chain does not suit a SerialArm, a mimic is out of range, the number of
  /// joints with a drive is not N, or a joint cannot move without a follower that leaves its bounds.
  explicit CoupledArm(const Chain<Scalar>& chain) : chain_(without_mimics(chain)) {
    const auto length = static_cast<Eigen::Index>(chain.joints.size());
    Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1> column(length);
    Eigen::Index dof = 0;
    for (Eigen::Index i = 0; i < length; ++i) column(i) = drives(chain, i) ? dof++ : Eigen::Index(-1);
    validation::require_dof("joints with a drive", dof, 1);
    if constexpr (N != Eigen::Dynamic) validation::require_size("joints with a drive", dof, N);

    A_.setZero(length, dof);
    b_.setZero(length);
    limits_ = JointLimits<N, Scalar>::none(dof);
    for (Eigen::Index i = 0; i < length; ++i) {
      const Joint<Scalar>& joint = chain.joints[static_cast<std::size_t>(i)];
      if (drives(chain, i)) {
        A_(i, column(i)) = Scalar(1);
        limits_.set(column(i), joint.bounds);
        continue;
      }
      const validation::Argument name = validation::element("joints", i) + ".mimic";
      const Mimic<Scalar>& mimic = joint.mimic;
      if (mimic.joint >= length || column(mimic.joint) < 0) {
        validation::fail(name + ".joint", mimic.joint, "the index of a joint with a drive of its own");
      }
      validation::require_finite(name + ".ratio", mimic.ratio);
      validation::require_finite(name + ".offset", mimic.offset);
      A_(i, column(mimic.joint)) = mimic.ratio;
      b_(i) = mimic.offset;
    }
    for (Eigen::Index i = 0; i < length; ++i) {
      if (!drives(chain, i)) bound_leader(chain, i, column(chain.joints[static_cast<std::size_t>(i)].mimic.joint));
    }
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(A_.cols()); }
  /// Bounds within which all joints of the chain keep theirs, those that follow included.
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return limits_; }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<3> and Pose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    Kinematics<Space, Eigen::Dynamic, Scalar> all;
    chain_.kinematics(Positions(A_.lazyProduct(q) + b_), Positions(A_.lazyProduct(qd)), all);
    out.tip = all.tip;
    out.length = all.length;
    out.J = all.J.lazyProduct(A_);
    out.Jd = all.Jd.lazyProduct(A_);
  }

  /// Tip and J at q; does not touch Jd.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    Kinematics<Space, Eigen::Dynamic, Scalar> all;
    chain_.kinematics(Positions(A_.lazyProduct(q) + b_), all);
    out.tip = all.tip;
    out.length = all.length;
    out.J = all.J.lazyProduct(A_);
  }

 private:
  using Positions = Vector<Eigen::Dynamic, Scalar>;

  static bool drives(const Chain<Scalar>& chain, Eigen::Index i) {
    return chain.joints[static_cast<std::size_t>(i)].mimic.joint < 0;
  }

  /// Narrows the bounds of drive k so that joint i, which follows it, keeps its own.
  void bound_leader(const Chain<Scalar>& chain, Eigen::Index i, Eigen::Index k) {
    const Joint<Scalar>& joint = chain.joints[static_cast<std::size_t>(i)];
    const JointBounds<Scalar>& bounds = joint.bounds;
    const auto& [leader, ratio, offset] = joint.mimic;
    if (ratio == Scalar(0)) {
      if (!(bounds.lower <= offset && offset <= bounds.upper)) {
        validation::fail(chain_check::name_of(chain, i) + ".mimic.offset", offset,
                         "within its bounds, since its ratio is 0");
      }
      return;
    }
    Scalar& lower = limits_.lower(k);
    Scalar& upper = limits_.upper(k);
    const Scalar low = (bounds.lower - offset) / ratio;
    const Scalar high = (bounds.upper - offset) / ratio;
    lower = std::max(lower, std::min(low, high));
    upper = std::min(upper, std::max(low, high));
    limits_.velocity(k) = std::min(limits_.velocity(k), bounds.velocity / std::abs(ratio));
    limits_.acceleration(k) = std::min(limits_.acceleration(k), bounds.acceleration / std::abs(ratio));
    limits_.jerk(k) = std::min(limits_.jerk(k), bounds.jerk / std::abs(ratio));
    if (bounds.deceleration < JointBounds<Scalar>::kNone) {
      validation::fail(chain_check::name_of(chain, i) + ".deceleration", bounds.deceleration,
                       "infinite, since the joint follows another");
    }
    if (!(lower < upper)) {
      validation::fail(chain_check::name_of(chain, leader) + ".lower", lower, "below upper = ", upper,
                       " for its followers to keep their bounds");
    }
  }

  static Chain<Scalar> without_mimics(Chain<Scalar> chain) {
    for (Joint<Scalar>& joint : chain.joints) joint.mimic = {};
    return chain;
  }

  SerialArm<Eigen::Dynamic, Scalar> chain_;
  Matrix<Eigen::Dynamic, N, Scalar> A_;
  Positions b_;
  JointLimits<N, Scalar> limits_ = JointLimits<N, Scalar>::none(N == Eigen::Dynamic ? 0 : N);
};

}  // namespace fpbm
