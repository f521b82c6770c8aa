#pragma once

#include <array>
#include <cmath>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/sincos.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/linalg/three.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/link.hpp"

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

  /// Placements of all joints at q, for tasks at velocity level: their J̇ is left as it is.
  void update(const Vector<N, Scalar>& q, State& state) const noexcept {
    update(q, filled<Vector<N, Scalar>>(dof_), state);
    state.moves = false;
  }

  /// Placements and angular velocities of all joints at (q, qd).
  void update(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd, State& state) const noexcept {
    state.q = q;
    state.qd = qd;
    state.moves = true;
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

  /// A frame fixed to a link, at offset in the link's frame, seen from the link's joint. Constant: for the constructor
  /// of what asks for frame() at every tick.
  [[nodiscard]] Transform<Scalar> in_joint(int link, const Transform<Scalar>& offset) const noexcept {
    return (link == kTip ? tip_ : ends_[index(link)]) * offset;
  }
  /// That frame in the base frame. seen: in_joint().
  [[nodiscard]] Transform<Scalar> frame(const State& state, int link, const Transform<Scalar>& seen) const noexcept {
    return state.placement[index(joints_before(link))] * seen;
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
      const Vector3 l = turns_.coeff(i) > Scalar(0) ? cross(z, lever) : z;
      const Vector3 a = entrywise(z, [&](Eigen::Index k) { return turns_.coeff(i) * z.coeff(k); });
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
      const Vector3 a = entrywise(z, [&](Eigen::Index k) { return turns_.coeff(i) * z.coeff(k); });
      store(J, 0, i, a);
      if (state.moves) store(Jd, 0, i, cross(column(state.w, i), a));
    }
  }

 private:
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] Eigen::Index joints_before(int link) const noexcept { return link == kTip ? dof_ : link; }

  /// Gives J and J̇ their size, and zeros in the columns of joints beyond a link.
  template <int M>
  void start(int link, const State& state, Matrix<M, N, Scalar>& J, Matrix<M, N, Scalar>& Jd) const noexcept {
    J.resize(M, dof_);
    Jd.resize(M, dof_);
    for (Eigen::Index j = joints_before(link); j < dof_; ++j) {
      for (int i = 0; i < M; ++i) J.coeffRef(i, j) = Scalar(0);
      for (int i = 0; state.moves && i < M; ++i) Jd.coeffRef(i, j) = Scalar(0);
    }
  }
  template <int M>
  static void store(Matrix<M, N, Scalar>& to, int row, Eigen::Index j, const Vector3& from) noexcept {
    for (int k = 0; k < 3; ++k) to.coeffRef(row + k, j) = from.coeff(k);
  }

  Eigen::Index dof_;
  std::array<Transform<Scalar>, kCapacity<N>> steps_;     ///< From a joint's frame to the next joint's, at zero.
  std::array<Transform<Scalar>, kCapacity<N> + 1> ends_;  ///< From a joint's placement to its link's frame.
  Transform<Scalar> tip_;                                 ///< From the last joint's placement.
  Vector<N, Scalar> turns_;                               ///< 1, or 0 for a prismatic joint.
  Scalar length_{0};                                      ///< [m]
  JointLimits<N, Scalar> limits_;
};

}  // namespace fpbm
