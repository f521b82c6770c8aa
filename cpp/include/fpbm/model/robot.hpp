#pragma once

#include <array>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/detail/drives.hpp"
#include "fpbm/model/detail/link_tree.hpp"
#include "fpbm/model/detail/robot_state.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// Tree of joints. N joints have a drive, and the other joints follow a drive. Tasks refer to the links of the robot.
/// Immutable.
///
/// Link 0 is the base. Joint i, counted from 0, moves link i + 1. The frame of link i + 1 is the frame of joint i after
/// the motion of the joint. kTip is the tip of a chain. Joints: number of joints, N by default.
template <int N, typename Scalar_ = double, int Joints = N>
class Robot {
 public:
  using Scalar = Scalar_;
  using State = RobotState<N, Scalar, Joints>;
  using Vector3 = Vector<3, Scalar>;
  using Columns = typename Screws<Joints, Scalar>::ColumnPair;  ///< Two columns of J or J̇.
  static constexpr int kDof = N;
  static constexpr int kTip = -1;

  /// Throws std::invalid_argument under the conditions of require_joints() and Drives.
  template <int Length = Eigen::Dynamic>
  explicit Robot(const Chain<Scalar, Length>& chain) : tree_(chain, require_joints(chain)), drives_(chain) {
    tip_link_ = joints();
    tip_ = tree_.end(tip_link_) * chain.tip;
    set_length(chain_length<Scalar>(chain, tip_link_) + norm(chain.tip.p));
  }

  /// Throws std::invalid_argument under the conditions of require_tree() and Drives.
  template <int Length, int Frames>
  explicit Robot(const Tree<Scalar, Length, Frames>& tree) : tree_(tree, require_tree(tree)), drives_(tree) {
    masses_[0] = tree.base;
    for (int link = 1; link <= joints(); ++link) {
      const LinkInertia<Scalar>& moved = tree.joints[index(link - 1)].joint.moved;
      masses_[index(link)] = {moved.mass, times(tree_.end(link).R, moved.centre)};
    }
    set_length(longest_chain<Scalar>(tree));
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(drives_.count()); }
  /// Number of joints, including joints that follow others.
  [[nodiscard]] int joints() const noexcept { return tree_.joints(); }
  /// Bounds on the drives within which all joints keep their bounds.
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return drives_.limits(); }
  /// Characteristic length [m]: SerialArm::length(), or the length of the longest chain to a frame or a joint of a
  /// tree.
  [[nodiscard]] Scalar length() const noexcept { return length_; }
  [[nodiscard]] const Drives<N, Joints, Scalar>& drives() const noexcept { return drives_; }
  /// Whether joint i, counted from 0, is revolute, and not prismatic.
  [[nodiscard]] bool turns(Eigen::Index i) const noexcept { return tree_.turns(i); }
  /// Bits of the joints that move a link.
  [[nodiscard]] JointBits moved_by(int link) const noexcept { return tree_.moved_by(number_of(link)); }
  /// Number of the parent link: the link that carries the joint of `link`.
  [[nodiscard]] int parent(int link) const noexcept { return tree_.parent(number_of(link)); }
  /// Mass of a link, with its centre relative to the placement of the joint.
  [[nodiscard]] const LinkMass<Scalar>& mass(int link) const noexcept { return masses_[index(link)]; }

  /// Throws std::invalid_argument unless link is 0 to joints(), or kTip for a chain.
  void require_link(const char* name, int link) const {
    if (link == kTip && tip_link_ == kTip) {
      validation::fail(name, link, "the number of a link: a tree has no tip, name one of its frames");
    }
    if (link < kTip || link > joints()) {
      validation::fail(name, link, "the number of a link, at most ", joints(),
                       tip_link_ == kTip ? "" : ", or Robot::kTip");
    }
  }

  /// Placements of all joints at q, for tasks at velocity level, which need no J̇.
  void update(const Vector<N, Scalar>& q, State& state) const noexcept {
    update(q, filled<Vector<N, Scalar>>(dof()), state);
    state.moves = false;
  }

  /// Placements and angular velocities of all joints at (q, qd).
  void update(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd, State& state) const noexcept {
    state.q = q;
    state.qd = qd;
    state.moves = true;
    if constexpr (Drives_::kMayFollow) {
      if (drives_.follows()) {
        state.joint_qd = drives_.rates(qd);
        return tree_.place(drives_.positions(q), state.joint_qd, state);
      }
    }
    if constexpr (N == Joints) tree_.place(q, qd, state);
  }

  /// Frame fixed to a link, relative to the placement of the joint of the link. offset: the frame relative to the frame
  /// of the link. The result is constant: compute it once, and not in every tick.
  [[nodiscard]] Transform<Scalar> in_joint(int link, const Transform<Scalar>& offset) const noexcept {
    return (link == kTip ? tip_ : tree_.end(link)) * offset;
  }
  /// A frame of a link in the base frame. seen: result of in_joint().
  [[nodiscard]] Transform<Scalar> frame(const State& state, int link, const Transform<Scalar>& seen) const noexcept {
    return state.placement(index(number_of(link))) * seen;
  }
  /// Axes of a frame of a link in the base frame, as columns. seen: R of in_joint().
  [[nodiscard]] Matrix<3, 3, Scalar> axes(const State& state, int link,
                                          const Matrix<3, 3, Scalar>& seen) const noexcept {
    return times(state.R[index(number_of(link))], seen);
  }
  /// Origin of a frame of a link in the base frame [m]. seen: p of in_joint().
  [[nodiscard]] Vector3 point(const State& state, int link, const Vector3& seen) const noexcept {
    const std::size_t joint = index(number_of(link));
    const Vector3 turned = times(state.R[joint], seen);
    return entrywise(turned, [&](Eigen::Index i) { return state.p[joint].coeff(i) + turned.coeff(i); });
  }
  /// Angular velocity of a link, along the axes of the base frame [rad/s].
  [[nodiscard]] Vector3 angular_velocity(const State& state, int link) const noexcept {
    return state.angular_velocity(number_of(link));
  }

  /// Calls f(i, columns, rates) with columns i and i + 1 of J and of J̇ of a point p of a link, along the axes of the
  /// base frame: linear rows [m] above angular rows [rad]. Returns the velocity of the point [m/s]. The columns of
  /// joints that do not move the link are 0. J̇ is 0 if the state has no velocities (docs/kinematics.md, Time derivative
  /// of J).
  template <typename F>
  [[gnu::always_inline]] Vector3 columns(const State& state, int link, const Vector3& p, const F& f) const noexcept {
    if constexpr (Drives_::kMayFollow) {
      if (drives_.follows()) return columns_of_drives(state, link, p, f);
    }
    typename Axes::Point point(SplitVector<Scalar>::load(p.data()));
    tree_.each_column(state, number_of(link), point, joint_rates(state), f);
    return point.velocity();
  }

  /// columns() for the angular rows only.
  template <typename F>
  [[gnu::always_inline]] void angular_columns(const State& state, int link, const F& f) const noexcept {
    if constexpr (Drives_::kMayFollow) {
      if (drives_.follows()) {
        const auto angular = [&](Eigen::Index i, const auto& J, const auto& Jd) { f(i, J.angular, Jd.angular); };
        return (void)columns_of_drives(state, link, filled<Vector3>(3), angular);
      }
    }
    tree_.each_angular_column(state, number_of(link), f);
  }

  /// J and J̇ of columns() as matrices with 3 linear rows, or with 3 linear above 3 angular rows. Returns the velocity
  /// of the point [m/s].
  template <int M>
  Vector3 jacobian(const State& state, int link, const Vector3& p, Matrix<M, N, Scalar>& J,
                   Matrix<M, N, Scalar>& Jd) const noexcept {
    static_assert(M == 3 || M == 6, "M must be 3 (linear rows) or 6 (linear and angular rows)");
    J.resize(M, dof());
    Jd.resize(M, dof());
    return columns(state, link, p, [&](Eigen::Index i, const auto& columns, const auto& rates) noexcept {
      columns.store(J, i);
      rates.store(Jd, i);
    });
  }

  /// Velocities of all joints in a state [rad/s] or [m/s].
  [[nodiscard]] const Vector<Joints, Scalar>& joint_rates(const State& state) const noexcept {
    if constexpr (N == Joints) {
      return drives_.follows() ? state.joint_qd : state.qd;
    } else {
      return state.joint_qd;
    }
  }

 private:
  using Axes = typename LinkTree<Joints, Scalar>::Axes;
  using Drives_ = Drives<N, Joints, Scalar>;

  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] int number_of(int link) const noexcept { return link == kTip ? tip_link_ : link; }

  /// columns() for a robot with joints that follow others.
  template <typename F>
  Vector3 columns_of_drives(const State& state, int link, const Vector3& p, const F& f) const noexcept {
    typename Axes::Point point(SplitVector<Scalar>::load(p.data()));
    const auto of_joints = [&](const auto& set) noexcept {
      tree_.each_column(state, number_of(link), point, joint_rates(state), set);
    };
    drives_.template each_column<Columns>(of_joints, f);
    return point.velocity();
  }

  void set_length(Scalar length) noexcept { length_ = length > Scalar(0) ? length : Scalar(1); }

  LinkTree<Joints, Scalar> tree_;
  Drives_ drives_;
  std::array<LinkMass<Scalar>, static_cast<std::size_t>(kCapacity<Joints>) + 1> masses_;
  int tip_link_ = kTip;
  Transform<Scalar> tip_;  ///< Relative to the placement of the last joint.
  Scalar length_{1};       ///< [m]
};

}  // namespace fpbm
