#pragma once

#include <array>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/frame.hpp"
#include "fpbm/model/screws.hpp"
#include "fpbm/model/serial_arm.hpp"

namespace fpbm {

/// State of a robot, which tasks read: placements in the base frame, and angular velocities in its axes.
/// Robot::update() fills it.
template <int N, typename Scalar = double>
struct RobotState {
  Vector<N, Scalar> q;   ///< [rad] or [m]
  Vector<N, Scalar> qd;  ///< [rad/s] or [m/s]
  /// Of the base and each joint; z is the joint's axis.
  std::array<Vector<3, Scalar>, kCapacity<N> + 1> p;
  std::array<Matrix<3, 3, Scalar>, kCapacity<N> + 1> R;
  Screws<N, Scalar> screws;  ///< Axes of the joints, and how their links turn.
  bool moves = true;         ///< False: qd was not given, J̇ is not needed.

  RobotState() noexcept {}  // NOLINT(modernize-use-equals-default): braces would set all bytes to 0.

  [[nodiscard]] Transform<Scalar> placement(std::size_t i) const noexcept { return {p[i], R[i]}; }
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
      ends_[index(i + 1)] = inverse(zero.placement(index(i + 1))) * link;
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
    state.p[0] = filled<Vector3>(3);
    state.R[0] = identity<Matrix<3, 3, Scalar>>();
    arm_.place(q, qd, state.screws, [&](Eigen::Index i, const Frame<Scalar>& frame) noexcept {
      frame.store(state.p[index(i + 1)], state.R[index(i + 1)]);
    });
  }

  /// A frame fixed to a link, at offset in the link's frame, seen from the link's joint. Constant: for the constructor
  /// of what asks for frame() at every tick.
  [[nodiscard]] Transform<Scalar> in_joint(int link, const Transform<Scalar>& offset) const noexcept {
    return (link == kTip ? tip_ : ends_[index(link)]) * offset;
  }
  /// That frame in the base frame. seen: in_joint().
  [[nodiscard]] Transform<Scalar> frame(const State& state, int link, const Transform<Scalar>& seen) const noexcept {
    return state.placement(index(joints_before(link))) * seen;
  }

  /// Its axes, the columns. seen: those of in_joint().
  [[nodiscard]] Matrix<3, 3, Scalar> axes(const State& state, int link,
                                          const Matrix<3, 3, Scalar>& seen) const noexcept {
    return times(state.R[index(joints_before(link))], seen);
  }
  /// Its origin. seen: in_joint().
  [[nodiscard]] Vector3 point(const State& state, int link, const Vector3& seen) const noexcept {
    const std::size_t joint = index(joints_before(link));
    const Vector3 turned = times(state.R[joint], seen);
    return entrywise(turned, [&](Eigen::Index i) { return state.p[joint].coeff(i) + turned.coeff(i); });
  }
  /// Angular velocity of a link, in the base frame's axes [rad/s].
  [[nodiscard]] Vector3 angular_velocity(const State& state, int link) const noexcept {
    const Eigen::Index joints = joints_before(link);
    return joints > 0 ? state.screws.angular_velocity(joints - 1) : filled<Vector3>(3);
  }

  /// Calls f(i, columns, rates) with columns i and i + 1 of J and of J̇, in the base frame's axes, of a point p of a
  /// link: linear rows [m] and angular ones [rad]. Returns the velocity of the point [m/s].
  ///
  /// Column i of J is [l; a] = [z × (p − pᵢ); z] for a joint that turns, [z; 0] for one that slides. That of J̇ is
  /// [wᵢ × l + a × uᵢ; wᵢ × a], where uᵢ = Σ_{j>i} q̇ⱼ lⱼ (docs/equations.md). Columns of joints beyond the link, and J̇
  /// of a state without velocities, are 0.
  template <typename F>
  [[gnu::always_inline]] Vector3 columns(const State& state, int link, const Vector3& p, const F& f) const noexcept {
    typename Axes::Point point(SplitVector<Scalar>::load(p.data()));
    const bool slides = arm_.slides();
    each_pair(state, link, [&](Eigen::Index i, const typename Axes::JointPair& joints) noexcept {
      const auto columns = Axes::columns(i, joints, point, arm_.turns(), slides);
      f(i, columns, state.moves ? Axes::rates(i, joints, columns, point, state.qd) : Axes::ColumnPair::zero());
    });
    return point.velocity();
  }

  /// The same of the angular rows alone.
  template <typename F>
  [[gnu::always_inline]] void angular_columns(const State& state, int link, const F& f) const noexcept {
    const bool slides = arm_.slides();
    each_pair(state, link, [&](Eigen::Index i, const typename Axes::JointPair& joints) noexcept {
      const auto columns = Axes::angular_columns(i, joints, arm_.turns(), slides);
      f(i, columns, Axes::angular_rates(joints, columns));
    });
  }

  /// J and J̇ of a point p of a link, as columns(), as matrices: linear rows, or linear and then angular ones.
  template <int M>
  void jacobian(const State& state, int link, const Vector3& p, Matrix<M, N, Scalar>& J,
                Matrix<M, N, Scalar>& Jd) const noexcept {
    static_assert(M == 3 || M == 6, "a frame has 3 linear rows, and 3 angular ones");
    J.resize(M, dof());
    Jd.resize(M, dof());
    columns(state, link, p, [&](Eigen::Index i, const auto& columns, const auto& rates) noexcept {
      columns.store(J, i);
      rates.store(Jd, i);
    });
  }

 private:
  using Axes = Screws<N, Scalar>;

  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] Eigen::Index joints_before(int link) const noexcept { return link == kTip ? dof() : link; }

  /// Calls f(i, joints) with joints i and i + 1, those nearest to the link first; those beyond the link have no axis.
  template <typename F>
  [[gnu::always_inline]] void each_pair(const State& state, int link, const F& f) const noexcept {
    const auto pairs = pairs_of(extent<N>(dof()));
    const Eigen::Index moving = joints_before(link);
    if (moving == dof()) {
      each(Constant<0>{}, pairs, [&](auto k) noexcept {
        const Eigen::Index i = 2 * (pairs - 1 - Eigen::Index(k));
        f(i, state.screws.joints(i));
      });
      return;
    }
    for (Eigen::Index i = 2 * (pairs - 1); i >= 0; i -= 2) f(i, state.screws.joints(i).first(moving - i));
  }

  SerialArm<N, Scalar> arm_;
  std::array<Transform<Scalar>, kCapacity<N> + 1> ends_;  ///< From a joint's placement to its link's frame.
  Transform<Scalar> tip_;                                 ///< From the last joint's placement.
};

}  // namespace fpbm
