#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/sincos.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/model/link.hpp"
#include "fpbm/model/screws.hpp"

namespace fpbm {

/// Any chain of N revolute, continuous and prismatic joints, in space. Immutable.
///
/// Joint positions in radians or metres; the first joint's placement is given in the base frame.
/// N = Eigen::Dynamic takes the number of joints from the chain, up to kMaxDof.
template <int N, typename Scalar_ = double>
class SerialArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// Throws std::invalid_argument where the number of joints is not N or exceeds kMaxDof, an axis is zero, a number is
  /// not finite, a placement's R is no rotation, or a joint's lower bound is not below its upper.
  explicit SerialArm(const Chain<Scalar>& chain)
      : dof_(require_chain(chain, N)), limits_(JointLimits<N, Scalar>::none(dof_)) {
    turns_.setOnes(dof_);
    offsets_.setZero(dof_);
    Matrix<3, 3, Scalar> turned_back = Matrix<3, 3, Scalar>::Identity();
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const Joint<Scalar>& joint = chain.joints[static_cast<std::size_t>(i)];
      const Matrix<3, 3, Scalar> to_axis = z_to(joint.axis);
      const Matrix<3, 3, Scalar> R = turned_back * joint.placement.R * to_axis;
      const Vector3 p = turned_back * joint.placement.p;
      turned_back = to_axis.transpose();
      if (i == 0) {
        base_ = {p, R};
      } else {
        const DecomposedLink<Scalar> between({p, R});
        links_[static_cast<std::size_t>(i - 1)] = between.link;
        offsets_(i - 1) += between.before;
        offsets_(i) = between.after;
      }
      if (joint.type == JointType::kPrismatic) {
        turns_(i) = Scalar(0);
        slides_ |= std::uint32_t(1) << i;
        const Scalar range = joint.bounds.upper - joint.bounds.lower;
        if (std::isfinite(range)) length_ += range;
      }
      if (i > 0) length_ += joint.placement.p.norm();
      limits_.set(i, joint.bounds);
    }
    length_ += chain.tip.p.norm();
    if (!(length_ > Scalar(0))) length_ = Scalar(1);
    links_[static_cast<std::size_t>(dof_ - 1)] = {turned_back * chain.tip.p, Scalar(1), Scalar(0)};
    tip_ = turned_back * chain.tip.R;
  }

  /// The same arm for another Scalar.
  template <typename Other>
  [[nodiscard]] SerialArm<N, Other> cast() const {
    return SerialArm<N, Other>(*this);
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(dof_); }
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return limits_; }

  /// Characteristic length [m]: the way from the first joint to the tip, from joint to joint, with the finite ranges of
  /// prismatic joints. 1 where that is zero.
  [[nodiscard]] Scalar length() const noexcept { return length_; }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<3> and Pose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    forward_pass<true>(q, qd, out);
  }

  /// Tip and J at q; does not touch Jd.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    forward_pass<false>(q, q, out);
  }

 private:
  template <int, typename>
  friend class SerialArm;

  template <typename Other>
  explicit SerialArm(const SerialArm<N, Other>& arm)
      : dof_(arm.dof_),
        base_(arm.base_.template cast<Scalar>()),
        turns_(arm.turns_.template cast<Scalar>()),
        offsets_(arm.offsets_.template cast<Scalar>()),
        slides_(arm.slides_),
        tip_(arm.tip_.template cast<Scalar>()),
        length_(static_cast<Scalar>(arm.length_)),
        limits_(arm.limits_.template cast<Scalar>()) {
    for (std::size_t i = 0; i < links_.size(); ++i) links_[i] = arm.links_[i].template cast<Scalar>();
  }

  using Vector3 = Vector<3, Scalar>;

  [[nodiscard]] bool slides(Eigen::Index i) const noexcept { return (slides_ >> i & 1U) != 0; }

  /// A pass along the chain finds the joints' axes; J and Jd follow from these. The column of a prismatic joint is
  /// [zᵢ; 0].
  template <bool kWithRate, typename Space>
  [[gnu::flatten]] void forward_pass(const Vector<N, Scalar>& q, [[maybe_unused]] const Vector<N, Scalar>& qd,
                                     Kinematics<Space, N, Scalar>& out) const noexcept {
    constexpr bool kWithOrientation = std::is_same_v<Space, Pose>;
    static_assert(kWithOrientation || std::is_same_v<Space, Position<3>>,
                  "a serial arm has tasks Position<3> and Pose");
    const Vector<N, Scalar> angles = turns_.cwiseProduct(q) + offsets_;
    Vector<N, Scalar> sines;
    Vector<N, Scalar> cosines;
    sincos(angles, sines, cosines);

    Screws<N, Scalar> screws(dof_);
    Vector3 p = base_.p;
    Vector3 x = base_.R.col(0);
    Vector3 y = base_.R.col(1);
    Vector3 z = base_.R.col(2);
    Vector3 v = Vector3::Zero();  // Velocity of p.
    Vector3 w = Vector3::Zero();  // Angular velocity of the frame.
    const auto advance = [&](const Vector3& step) {
      p += step;
      if constexpr (kWithRate) v += cross(w, step);
    };
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const Link<Scalar>& link = links_[static_cast<std::size_t>(i)];
      screws.axes.row(i) = z;
      if constexpr (kWithRate) screws.axis_rates.row(i) = cross(w, z);
      if (slides(i)) {
        advance(q(i) * z);
        if constexpr (kWithRate) v += qd(i) * z;
      } else if constexpr (kWithRate) {
        w += qd(i) * z;
      }
      screws.points.row(i) = p;
      if constexpr (kWithRate) screws.point_rates.row(i) = v;

      const Vector3 turned = cosines(i) * x + sines(i) * y;
      y = cosines(i) * y - sines(i) * x;
      x = turned;
      advance(link.step(0) * x + link.step(1) * y + link.step(2) * z);
      const Vector3 tilted = link.cosine * y + link.sine * z;
      z = link.cosine * z - link.sine * y;
      y = tilted;
    }

    out.length = length_;
    out.J.resize(Space::kRows, dof_);
    screws.template relative_to_tip<kWithRate>(p, v);
    screws.columns(out.J);
    if constexpr (kWithRate) {
      out.Jd.resize(Space::kRows, dof_);
      screws.column_rates(out.Jd);
    }
    for (Eigen::Index i = 0; slides_ != 0 && i < dof_; ++i) {
      if (!slides(i)) continue;
      slide(screws.axes.row(i), out.J.col(i));
      if constexpr (kWithRate) slide(screws.axis_rates.row(i), out.Jd.col(i));
    }
    if constexpr (kWithOrientation) {
      Matrix<3, 3, Scalar> R;
      R << x, y, z;
      out.tip = {p, R.lazyProduct(tip_)};
    } else {
      out.tip = p;
    }
  }

  /// The column of a prismatic joint.
  template <typename Axis, typename Column>
  static void slide(const Axis& axis, Column&& column) noexcept {
    column.setZero();
    column.template head<3>() = axis;
  }

  Eigen::Index dof_;
  Transform<Scalar> base_;                        ///< The first joint's frame at zero.
  std::array<Link<Scalar>, kCapacity<N>> links_;  ///< From each joint's frame to the next.
  Vector<N, Scalar> turns_;  ///< 1, or 0 for a prismatic joint: a frame's angle is turns q + offset.
  Vector<N, Scalar> offsets_;
  std::uint32_t slides_ = 0;  ///< Bit i is set where joint i is prismatic.
  Matrix<3, 3, Scalar> tip_;  ///< The tip's orientation in the frame of the last link's end.
  Scalar length_{0};          ///< [m]
  JointLimits<N, Scalar> limits_;
};

}  // namespace fpbm
