#pragma once

#include <array>
#include <type_traits>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/sincos.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Any chain of N revolute, continuous and prismatic joints, in space. Immutable.
///
/// Joint positions in radians or metres; the base frame is the one that the first placement is seen from.
/// N = Eigen::Dynamic takes the number of joints from the chain, up to kMaxDof.
template <int N, typename Scalar_ = double>
class SerialArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// Throws std::invalid_argument where the number of joints is not N or beyond kMaxDof, an axis is zero, a number is
  /// not finite, a placement's R is no rotation, or a joint's bounds leave it no room.
  explicit SerialArm(const Chain<Scalar>& chain)
      : dof_(require_chain(chain, N)), limits_(JointLimits<N, Scalar>::none(dof_)) {
    // Each joint's frame is turned so that its axis is z: then all joints move alike.
    Matrix<3, 3, Scalar> turned_back = Matrix<3, 3, Scalar>::Identity();
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const Joint<Scalar>& joint = chain.joints[i];
      const Matrix<3, 3, Scalar> to_axis = z_to(joint.axis);
      links_[i] = {turned_back * joint.placement.p, turned_back * joint.placement.R * to_axis};
      turned_back = to_axis.transpose();
      slides_[i] = joint.type == JointType::kPrismatic;
      limits_.set(static_cast<Eigen::Index>(i), joint.bounds);
    }
    tip_ = {turned_back * chain.tip.p, turned_back * chain.tip.R};
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(dof_); }
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return limits_; }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<3> and Pose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    sweep<true>(q, qd, out);
  }

  /// Tip and J at q; leaves Jd alone.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    sweep<false>(q, q, out);
  }

 private:
  using Row3 = Vector<3, Scalar>;

  /// Out along the chain for axes zᵢ, origins pᵢ and their rates; then column i of J is [zᵢ × (p − pᵢ); zᵢ] for a
  /// revolute joint, [zᵢ; 0] for a prismatic one, and column i of Jd its rate.
  template <bool kWithRate, typename Space>
  void sweep(const Vector<N, Scalar>& q, [[maybe_unused]] const Vector<N, Scalar>& qd,
             Kinematics<Space, N, Scalar>& out) const noexcept {
    constexpr bool kWithTurn = std::is_same_v<Space, Pose>;
    static_assert(kWithTurn || std::is_same_v<Space, Position<3>>, "a serial arm has tasks Position<3> and Pose");
    out.J.resize(Space::kRows, dof_);
    if constexpr (kWithRate) out.Jd.resize(Space::kRows, dof_);
    Vector<N, Scalar> sines;
    Vector<N, Scalar> cosines;
    sincos(q, sines, cosines);

    std::array<Row3, kCapacity<N>> origins;
    std::array<Row3, kCapacity<N>> velocities;
    std::array<Row3, kCapacity<N>> axes;
    std::array<Row3, kCapacity<N>> axis_rates;
    Transform<Scalar> frame;
    Row3 v = Row3::Zero();  // Of the frame's origin,
    Row3 w = Row3::Zero();  // and the frame's angular velocity.
    const auto advance = [&](const Row3& step) {
      frame.p += step;
      if constexpr (kWithRate) v += cross(w, step);
    };
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      advance(frame.R.lazyProduct(links_[k].p));
      frame.R = frame.R.lazyProduct(links_[k].R).eval();
      const Row3 z = frame.R.col(2);
      axes[k] = z;
      if constexpr (kWithRate) axis_rates[k] = cross(w, z);
      if (!slides_[k]) {
        const Row3 x = frame.R.col(0);
        frame.R.col(0) = cosines(i) * x + sines(i) * frame.R.col(1);
        frame.R.col(1) = cosines(i) * frame.R.col(1) - sines(i) * x;
        if constexpr (kWithRate) w += qd(i) * z;
      } else {
        advance(q(i) * z);
        if constexpr (kWithRate) v += qd(i) * z;
      }
      origins[k] = frame.p;
      if constexpr (kWithRate) velocities[k] = v;
    }
    advance(frame.R.lazyProduct(tip_.p));

    for (Eigen::Index i = 0; i < dof_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const bool turns = !slides_[k];
      const Row3 arm = frame.p - origins[k];
      out.J.col(i).template head<3>() = turns ? cross(axes[k], arm) : axes[k];
      if constexpr (kWithTurn) out.J.col(i).template tail<3>() = turns ? axes[k] : Row3::Zero();
      if constexpr (kWithRate) {
        const Row3 rate = v - velocities[k];
        out.Jd.col(i).template head<3>() =
            turns ? Row3(cross(axis_rates[k], arm) + cross(axes[k], rate)) : axis_rates[k];
        if constexpr (kWithTurn) out.Jd.col(i).template tail<3>() = turns ? axis_rates[k] : Row3::Zero();
      }
    }
    if constexpr (kWithTurn) {
      out.tip = {frame.p, frame.R.lazyProduct(tip_.R)};
    } else {
      out.tip = frame.p;
    }
  }

  /// A rotation that takes z to the axis.
  static Matrix<3, 3, Scalar> z_to(const Row3& axis) {
    Matrix<3, 3, Scalar> R;
    const Row3 z = axis.normalized();
    Eigen::Index least = 0;
    z.cwiseAbs().minCoeff(&least);
    if (z == Row3::UnitZ()) return Matrix<3, 3, Scalar>::Identity();
    const Row3 across = Row3::Unit(least);
    const Row3 x = cross(across, z).normalized();
    R.col(0) = x;
    R.col(1) = cross(z, x);
    R.col(2) = z;
    return R;
  }

  Eigen::Index dof_;
  std::array<Transform<Scalar>, kCapacity<N>> links_;
  std::array<bool, kCapacity<N>> slides_{};
  Transform<Scalar> tip_;
  JointLimits<N, Scalar> limits_;
};

}  // namespace fpbm
