#pragma once

#include <array>
#include <cmath>
#include <string>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/sincos.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/linalg/three.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/link.hpp"

namespace fpbm {

/// State of a robot, which tasks read: where its links are, and how they turn. Robot::update() fills it.
template <int N, typename Scalar = double>
struct RobotState {
  Vector<N, Scalar> q;                                        ///< [rad] or [m]
  Vector<N, Scalar> qd;                                       ///< [rad/s] or [m/s]
  std::array<Transform<Scalar>, kCapacity<N> + 1> placement;  ///< Of the base and each joint; z is the joint's axis.
  Matrix<3, N, Scalar> w;  ///< Column i: angular velocity of the link that joint i moves [rad/s].
};

/// A chain of N joints, whose links tasks refer to. Immutable.
///
/// Link 0 is the base, link i the link that joint i moves, counted from 1, with the joint's frame after its motion.
/// kTip is the chain's tip.
template <int N, typename Scalar_ = double>
class Robot {
 public:
  using Scalar = Scalar_;
  using State = RobotState<N, Scalar>;
  using Vector3 = Vector<3, Scalar>;
  static constexpr int kDof = N;
  static constexpr int kTip = -1;

  /// Throws std::invalid_argument as SerialArm does.
  template <int Length = Eigen::Dynamic>
  explicit Robot(const Chain<Scalar, Length>& chain)
      : dof_(require_chain(chain, N)), turns_(dof_), limits_(JointLimits<N, Scalar>::none(dof_)) {
    Matrix<3, 3, Scalar> back = identity<Matrix<3, 3, Scalar>>();
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const auto& joint = chain.joints[static_cast<std::size_t>(i)];
      const Matrix<3, 3, Scalar> to_axis = z_to(joint.axis);
      Transform<Scalar> turned_back;
      turned_back.R = back;
      steps_[index(i)] = turned_back * joint.placement;
      steps_[index(i)].R = times(steps_[index(i)].R, to_axis);
      back = transposed(to_axis);
      ends_[index(i + 1)].R = back;
      turns_(i) = joint.type == JointType::kPrismatic ? Scalar(0) : Scalar(1);
      if (turns_(i) == Scalar(0) && std::isfinite(joint.bounds.upper - joint.bounds.lower)) {
        length_ += joint.bounds.upper - joint.bounds.lower;
      }
      if (i > 0) length_ += norm(joint.placement.p);
      limits_.set(i, joint.bounds);
    }
    length_ += norm(chain.tip.p);
    if (!(length_ > Scalar(0))) length_ = Scalar(1);
    tip_ = ends_[index(dof_)] * chain.tip;
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(dof_); }
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return limits_; }
  /// Characteristic length [m], as SerialArm::length().
  [[nodiscard]] Scalar length() const noexcept { return length_; }

  /// Throws std::invalid_argument unless link is kTip or 0 to dof().
  void require_link(const char* name, int link) const {
    if (link < kTip || link > dof()) {
      validation::fail(name, link, "the number of a link, at most ", dof(), ", or Robot::kTip");
    }
  }

  /// Positions of all joints and links at (q, qd).
  void update(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd, State& state) const noexcept {
    state.q = q;
    state.qd = qd;
    const Vector<N, Scalar> angles = entrywise(q, [&](Eigen::Index i) { return turns_.coeff(i) * q.coeff(i); });
    Vector<N, Scalar> sines(dof_);
    Vector<N, Scalar> cosines(dof_);
    sincos(angles, sines, cosines);
    state.placement[0] = {};
    state.w.resize(3, dof_);
    Vector3 w(Scalar(0), Scalar(0), Scalar(0));
    for (Eigen::Index i = 0; i < dof_; ++i) {
      Transform<Scalar>& frame = state.placement[index(i + 1)];
      frame = state.placement[index(i)] * steps_[index(i)];
      const Scalar slide = (Scalar(1) - turns_.coeff(i)) * q.coeff(i);
      const Scalar rate = turns_.coeff(i) * qd.coeff(i);
      const Scalar c = cosines.coeff(i);
      const Scalar s = sines.coeff(i);
      for (int k = 0; k < 3; ++k) {
        const Scalar x = frame.R.coeff(k, 0);
        const Scalar y = frame.R.coeff(k, 1);
        const Scalar z = frame.R.coeff(k, 2);
        frame.R.coeffRef(k, 0) = c * x + s * y;
        frame.R.coeffRef(k, 1) = c * y - s * x;
        frame.p.coeffRef(k) += slide * z;
        w.coeffRef(k) += rate * z;
        state.w.coeffRef(k, i) = w.coeff(k);
      }
    }
  }

  /// A frame fixed to a link, at offset in the link's frame.
  [[nodiscard]] Transform<Scalar> frame(const State& state, int link, const Transform<Scalar>& offset) const noexcept {
    const Transform<Scalar>& end = link == kTip ? tip_ : ends_[index(link)];
    return state.placement[index(joints_before(link))] * (end * offset);
  }

  /// J and J̇ of a frame of a link with its origin at p: linear rows first, then angular, in the base frame's axes.
  ///
  /// Column i of J is [l; a] = [z × (p − pᵢ); z] for a joint that turns, [z; 0] for one that slides. That of J̇ is
  /// [wᵢ × l + a × uᵢ; wᵢ × a], where uᵢ = Σ_{j>i} q̇ⱼ lⱼ (docs/equations.md). Columns of joints beyond the link are 0.
  void jacobian(const State& state, int link, const Vector3& p, Matrix<6, N, Scalar>& J,
                Matrix<6, N, Scalar>& Jd) const noexcept {
    J.setZero(6, dof_);
    Jd.setZero(6, dof_);
    Vector3 u(Scalar(0), Scalar(0), Scalar(0));
    for (Eigen::Index i = joints_before(link); i-- > 0;) {
      const Transform<Scalar>& placement = state.placement[index(i + 1)];
      const Vector3 z = placement.R.col(2);
      const Vector3 lever = entrywise(p, [&](Eigen::Index k) { return p.coeff(k) - placement.p.coeff(k); });
      const bool turns = turns_.coeff(i) > Scalar(0);
      const Vector3 l = turns ? cross(z, lever) : z;
      const Vector3 a = entrywise(z, [&](Eigen::Index k) { return turns_.coeff(i) * z.coeff(k); });
      const Vector3 w = column(state.w, i);
      const Vector3 turning = cross(w, l);
      const Vector3 carried = cross(a, u);
      const Vector3 ad = cross(w, a);
      for (int k = 0; k < 3; ++k) {
        J.coeffRef(k, i) = l.coeff(k);
        J.coeffRef(3 + k, i) = a.coeff(k);
        Jd.coeffRef(k, i) = turning.coeff(k) + carried.coeff(k);
        Jd.coeffRef(3 + k, i) = ad.coeff(k);
        u.coeffRef(k) += state.qd.coeff(i) * l.coeff(k);
      }
    }
  }

 private:
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] Eigen::Index joints_before(int link) const noexcept { return link == kTip ? dof_ : link; }

  Eigen::Index dof_;
  std::array<Transform<Scalar>, kCapacity<N>> steps_;     ///< From a joint's frame to the next joint's, at zero.
  std::array<Transform<Scalar>, kCapacity<N> + 1> ends_;  ///< From a joint's placement to its link's frame.
  Transform<Scalar> tip_;                                 ///< From the last joint's placement.
  Vector<N, Scalar> turns_;                               ///< 1, or 0 for a prismatic joint.
  Scalar length_{0};                                      ///< [m]
  JointLimits<N, Scalar> limits_;
};

}  // namespace fpbm
