#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/sincos.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/link.hpp"

namespace fpbm {

/// The links of an arm, where they are, and how far a joint can move what is on them.
///
/// Link 0 is the base, link i what the chain's joint i moves, counted from 1. Joints that follow another (mimic) are
/// joints of the chain as all others; drives() gives the chain's motion for that of the arm's N drives.
template <int N, typename Scalar = double>
class Links {
 public:
  using JointVector = Vector<N, Scalar>;
  using ChainVector = Vector<Eigen::Dynamic, Scalar>;
  using Vector3 = Vector<3, Scalar>;

  /// Frames of all links: that of link i has the axis of joint i as z, and lies at its origin.
  using Frames = std::array<Transform<Scalar>, kMaxDof + 1>;

  /// Throws std::invalid_argument as the arm's constructor does.
  explicit Links(const Chain<Scalar>& chain)
      : count_(static_cast<Eigen::Index>(chain.joints.size())), range_(count_), turns_(count_), b_(count_) {
    validation::require_dof("joints", count_, 1);
    Matrix<3, 3, Scalar> back = identity<Matrix<3, 3, Scalar>>();
    Eigen::Array<Eigen::Index, Eigen::Dynamic, 1> column(count_);
    Eigen::Index dof = 0;
    for (Eigen::Index i = 0; i < count_; ++i) {
      const Joint<Scalar>& joint = joint_of(chain, i);
      const Matrix<3, 3, Scalar> to_axis = z_to(joint.axis);
      steps_[index(i)] = {back * joint.placement.p, back * joint.placement.R * to_axis};
      to_axis_[index(i)] = to_axis;
      back = to_axis.transpose();
      turns_(i) = joint.type == JointType::kPrismatic ? Scalar(0) : Scalar(1);
      using std::abs;
      range_(i) = turns_(i) > Scalar(0) ? Scalar(0) : std::max(abs(joint.bounds.lower), abs(joint.bounds.upper));
      column(i) = joint.mimic.joint < 0 ? dof++ : Eigen::Index(-1);
    }
    if constexpr (N != Eigen::Dynamic) validation::require_size("joints with a drive", dof, N);
    follows_ = dof < count_;
    A_.setZero(count_, dof);
    b_.setZero();
    for (Eigen::Index i = 0; i < count_; ++i) {
      const Mimic<Scalar>& mimic = joint_of(chain, i).mimic;
      if (mimic.joint < 0) {
        A_(i, column(i)) = Scalar(1);
      } else {
        A_(i, column(mimic.joint)) = mimic.ratio;
        b_(i) = mimic.offset;
      }
    }
  }

  /// Number of joints of the chain, and so of links that move.
  [[nodiscard]] Eigen::Index count() const noexcept { return count_; }
  [[nodiscard]] Eigen::Index dof() const noexcept { return A_.cols(); }
  [[nodiscard]] bool turns(Eigen::Index joint) const noexcept { return turns_(joint) > Scalar(0); }

  /// Motion of the chain's joints for one of the drives.
  [[nodiscard]] ChainVector motion(const JointVector& drives) const noexcept {
    return follows_ ? ChainVector(A_.lazyProduct(drives)) : ChainVector(drives);
  }
  /// Least motion of each of the chain's joints for drives anywhere between low and high.
  [[nodiscard]] ChainVector least(const JointVector& low, const JointVector& high) const noexcept {
    if (!follows_) return low;
    return A_.cwiseMax(Scalar(0)).lazyProduct(low) + A_.cwiseMin(Scalar(0)).lazyProduct(high);
  }
  /// The other way for a gradient: its entries by drive.
  [[nodiscard]] JointVector by_drive(const ChainVector& gradient) const noexcept {
    return follows_ ? JointVector(A_.transpose().lazyProduct(gradient)) : JointVector(gradient);
  }

  /// A point of link i, given in the frame of its joint after its motion (link 0: the base frame), in the link's frame.
  [[nodiscard]] Vector3 in_frame(Eigen::Index link, const Vector3& point) const noexcept {
    return link == 0 ? point : Vector3(to_axis_[index(link - 1)].transpose() * point);
  }

  void place(const JointVector& q, Frames& frames) const noexcept {
    const ChainVector position = motion(q) + b_;
    const ChainVector angles = turns_.cwiseProduct(position);
    ChainVector sines(count_);
    ChainVector cosines(count_);
    sincos(angles, sines, cosines);
    frames[0] = {};
    for (Eigen::Index i = 0; i < count_; ++i) {
      Transform<Scalar>& frame = frames[index(i + 1)];
      frame = frames[index(i)] * steps_[index(i)];
      if (turns_(i) > Scalar(0)) {
        const Vector3 x = frame.R.col(0);
        const Vector3 y = frame.R.col(1);
        frame.R.col(0) = cosines(i) * x + sines(i) * y;
        frame.R.col(1) = cosines(i) * y - sines(i) * x;
      } else {
        frame.p += position(i) * frame.R.col(2);
      }
    }
  }

  /// How far the joints up to a link can move a point of it, given in the link's frame: no unit of joint k moves it by
  /// more than lever k in any posture. Its distance to a turning joint's axis is no longer than the way there along the
  /// chain, less the part of the first step along that axis. Infinite beyond a prismatic joint without ends.
  [[nodiscard]] ChainVector levers(Eigen::Index link, const Vector3& point) const noexcept {
    ChainVector lever = ChainVector::Zero(count_);
    Scalar beyond = Scalar(0);  // Length of the way from the next joint's origin to the point.
    Vector3 step = point;
    for (Eigen::Index k = link - 1; k >= 0; --k) {
      lever(k) = turns_(k) > Scalar(0) ? std::hypot(step(0), step(1)) + beyond : Scalar(1);
      beyond += step.norm() + range_(k);
      step = steps_[index(k)].p;
    }
    return lever;
  }

 private:
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] static const Joint<Scalar>& joint_of(const Chain<Scalar>& chain, Eigen::Index i) {
    return chain.joints[index(i)];
  }

  Eigen::Index count_;
  std::array<Transform<Scalar>, kMaxDof> steps_;  ///< From a link's frame to the next joint's, at zero.
  std::array<Matrix<3, 3, Scalar>, kMaxDof> to_axis_;
  ChainVector range_;                    ///< Most that a prismatic joint slides, either way.
  ChainVector turns_;                    ///< 1, or 0 for a prismatic joint.
  Matrix<Eigen::Dynamic, N, Scalar> A_;  ///< Chain positions are A q + b.
  ChainVector b_;
  bool follows_ = false;
};

}  // namespace fpbm
