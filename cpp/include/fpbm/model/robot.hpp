#pragma once

#include <array>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/frame.hpp"
#include "fpbm/model/serial_arm.hpp"

namespace fpbm {

/// State of a robot, which tasks read: placements in the base frame, and angular velocities in its axes.
/// Robot::update() fills it.
template <int N, typename Scalar = double>
struct RobotState {
  Vector<N, Scalar> q;                                        ///< [rad] or [m]
  Vector<N, Scalar> qd;                                       ///< [rad/s] or [m/s]
  std::array<Transform<Scalar>, kCapacity<N> + 1> placement;  ///< Of the base and each joint; z is the joint's axis.
  Matrix<3, N, Scalar> w;  ///< Column i: angular velocity of the link that joint i moves [rad/s].
  bool moves = true;       ///< False: qd was not given, J̇ is not needed.
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
  explicit Robot(const Chain<Scalar, Length>& chain) : arm_(chain) {
    State zero;
    update(filled<Vector<N, Scalar>>(dof()), zero);
    Transform<Scalar> link;
    for (int i = 0; i < dof(); ++i) {
      link = link * chain.joints[index(i)].placement;
      ends_[index(i + 1)] = inverse(zero.placement[index(i + 1)]) * link;
    }
    tip_ = ends_[index(dof())] * chain.tip;
  }

  [[nodiscard]] int dof() const noexcept { return arm_.dof(); }
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return arm_.limits(); }
  /// Characteristic length [m], as SerialArm::length().
  [[nodiscard]] Scalar length() const noexcept { return arm_.length(); }

  /// Throws std::invalid_argument unless link is kTip or 0 to dof().
  void require_link(const char* name, int link) const {
    if (link < kTip || link > dof()) {
      validation::fail(name, link, "the number of a link, at most ", dof(), ", or Robot::kTip");
    }
  }

  /// Placements of all joints at q, for tasks at velocity level: their J̇ is left as it is.
  void update(const Vector<N, Scalar>& q, State& state) const noexcept {
    update(q, filled<Vector<N, Scalar>>(dof()), state);
    state.moves = false;
  }

  /// Placements and angular velocities of all joints at (q, qd).
  void update(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd, State& state) const noexcept {
    state.q = q;
    state.qd = qd;
    state.moves = true;
    state.placement[0] = {};
    state.w.resize(3, dof());
    arm_.visit_joints(q, qd, [&](Eigen::Index i, const Frame<Scalar>& frame, const SplitVector<Scalar>& w) noexcept {
      frame.store(state.placement[index(i + 1)]);
      w.store(state.w.data() + 3 * i);
    });
  }

  /// A frame fixed to a link, at offset in the link's frame, seen from the link's joint. Constant: for the constructor
  /// of what asks for frame() at every tick.
  [[nodiscard]] Transform<Scalar> in_joint(int link, const Transform<Scalar>& offset) const noexcept {
    return (link == kTip ? tip_ : ends_[index(link)]) * offset;
  }
  /// That frame in the base frame. seen: in_joint().
  [[nodiscard]] Transform<Scalar> frame(const State& state, int link, const Transform<Scalar>& seen) const noexcept {
    return state.placement[index(joints_before(link))] * seen;
  }

  /// Its origin. seen: in_joint().
  [[nodiscard]] Vector3 point(const State& state, int link, const Vector3& seen) const noexcept {
    const Transform<Scalar>& placement = state.placement[index(joints_before(link))];
    const Vector3 turned = times(placement.R, seen);
    return entrywise(turned, [&](Eigen::Index i) { return placement.p.coeff(i) + turned.coeff(i); });
  }
  /// Angular velocity of a link, in the base frame's axes [rad/s].
  [[nodiscard]] Vector3 angular_velocity(const State& state, int link) const noexcept {
    const Eigen::Index joints = joints_before(link);
    return joints > 0 ? Vector3(column(state.w, joints - 1)) : filled<Vector3>(3);
  }

  /// J and J̇ of a frame of a link with its origin at p, in the base frame's axes: linear rows [m], or linear and then
  /// angular ones [rad].
  ///
  /// Column i of J is [l; a] = [z × (p − pᵢ); z] for a joint that turns, [z; 0] for one that slides. That of J̇ is
  /// [wᵢ × l + a × uᵢ; wᵢ × a], where uᵢ = Σ_{j>i} q̇ⱼ lⱼ (docs/equations.md). Columns of joints beyond the link are 0.
  template <int M>
  void jacobian(const State& state, int link, const Vector3& p, Matrix<M, N, Scalar>& J,
                Matrix<M, N, Scalar>& Jd) const noexcept {
    static_assert(M == 3 || M == 6, "a frame has 3 linear rows, and 3 angular ones");
    start(link, state, J, Jd);
    Vector3 u(Scalar(0), Scalar(0), Scalar(0));
    for (Eigen::Index i = joints_before(link); i-- > 0;) {
      const Transform<Scalar>& placement = state.placement[index(i + 1)];
      const Vector3 z = column(placement.R, 2);
      const Vector3 lever = entrywise(p, [&](Eigen::Index k) { return p.coeff(k) - placement.p.coeff(k); });
      const Vector3 l = arm_.turns().coeff(i) > Scalar(0) ? cross(z, lever) : z;
      const Vector3 a = entrywise(z, [&](Eigen::Index k) { return arm_.turns().coeff(i) * z.coeff(k); });
      store(J, 0, i, l);
      if constexpr (M == 6) store(J, 3, i, a);
      if (!state.moves) continue;
      const Vector3 w = column(state.w, i);
      const Vector3 turning = cross(w, l);
      const Vector3 carried = cross(a, u);
      store(Jd, 0, i, entrywise(l, [&](Eigen::Index k) { return turning.coeff(k) + carried.coeff(k); }));
      if constexpr (M == 6) store(Jd, 3, i, cross(w, a));
      u = entrywise(u, [&](Eigen::Index k) { return u.coeff(k) + state.qd.coeff(i) * l.coeff(k); });
    }
  }

  /// The angular rows of jacobian() [rad].
  void angular_jacobian(const State& state, int link, Matrix<3, N, Scalar>& J,
                        Matrix<3, N, Scalar>& Jd) const noexcept {
    start(link, state, J, Jd);
    for (Eigen::Index i = joints_before(link); i-- > 0;) {
      const Vector3 z = column(state.placement[index(i + 1)].R, 2);
      const Vector3 a = entrywise(z, [&](Eigen::Index k) { return arm_.turns().coeff(i) * z.coeff(k); });
      store(J, 0, i, a);
      if (state.moves) store(Jd, 0, i, cross(column(state.w, i), a));
    }
  }

 private:
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] Eigen::Index joints_before(int link) const noexcept { return link == kTip ? dof() : link; }

  /// Gives J and J̇ their size, and zeros in the columns of joints beyond a link.
  template <int M>
  void start(int link, const State& state, Matrix<M, N, Scalar>& J, Matrix<M, N, Scalar>& Jd) const noexcept {
    J.resize(M, dof());
    Jd.resize(M, dof());
    for (Eigen::Index j = joints_before(link); j < dof(); ++j) {
      for (int i = 0; i < M; ++i) J.coeffRef(i, j) = Scalar(0);
      for (int i = 0; state.moves && i < M; ++i) Jd.coeffRef(i, j) = Scalar(0);
    }
  }
  template <int M>
  static void store(Matrix<M, N, Scalar>& to, int row, Eigen::Index j, const Vector3& from) noexcept {
    for (int k = 0; k < 3; ++k) to.coeffRef(row + k, j) = from.coeff(k);
  }

  SerialArm<N, Scalar> arm_;
  std::array<Transform<Scalar>, kCapacity<N> + 1> ends_;  ///< From a joint's placement to its link's frame.
  Transform<Scalar> tip_;                                 ///< From the last joint's placement.
};

}  // namespace fpbm
