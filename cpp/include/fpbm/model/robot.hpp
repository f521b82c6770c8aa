#pragma once

#include <algorithm>
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
  explicit Robot(const Chain<Scalar, Length>& chain) : tree_(checked(chain)), drives_(chain) {
    tip_link_ = joints();
    tip_ = tree_.end(tip_link_) * chain.tip;
    set_length(chain_length<Scalar>(chain, tip_link_) + norm(chain.tip.p));
  }

  /// Throws std::invalid_argument under the conditions of require_tree() and Drives.
  template <int Length, int Frames>
  explicit Robot(const Tree<Scalar, Length, Frames>& tree) : tree_(checked(tree)), drives_(tree) {
    masses_[0] = tree.base;
    Scalar longest(0);
    for (int link = 1; link <= joints(); ++link) {
      const auto& [mass, centre] = tree.joints[index(link - 1)].moved;
      masses_[index(link)] = {mass, times(tree_.end(link).R, centre)};
      longest = std::max(longest, chain_length<Scalar>(tree, link));
    }
    for (const auto& frame : tree.frames) {
      if (frame.link > 0) longest = std::max(longest, chain_length<Scalar>(tree, frame.link) + norm(frame.offset.p));
    }
    set_length(longest);
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(drives_.count()); }
  /// Number of joints, including joints that follow others.
  [[nodiscard]] int joints() const noexcept { return tree_.joints(); }
  /// Bounds on the drives within which all joints keep their bounds.
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return drives_.limits(); }
  /// Characteristic length [m]. For a chain: SerialArm::length(). For a tree: the length of the longest chain to a
  /// frame or a joint.
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
  /// of the link. The result is constant: an object that calls frame() at every tick computes the result once, in its
  /// constructor.
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
  /// base frame: linear rows [m] above angular rows [rad]. Returns the velocity of the point [m/s].
  ///
  /// Column i of J is [l; a] = [z × (p − pᵢ); z] for a revolute joint, and [z; 0] for a prismatic joint. Column i of J̇
  /// is [wᵢ × l + a × uᵢ; wᵢ × a], where wᵢ is the angular velocity of link i + 1, and uᵢ = Σ_{j>i} q̇ⱼ lⱼ
  /// (docs/kinematics.md, Time derivative of J). The columns of joints that do not move the link are 0. J̇ is 0 if the
  /// state has no velocities.
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
        (void)columns_of_drives(
            state, link, filled<Vector3>(3),
            [&](Eigen::Index i, const auto& columns, const auto& rates) { f(i, columns.angular, rates.angular); });
        return;
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
  /// Sets columns of the drives from columns of all joints.
  template <int M>
  void set_by_drive(const Matrix<M, Joints, Scalar>& columns, Matrix<M, N, Scalar>& to) const noexcept {
    if constexpr (Drives_::kMayFollow) {
      to = drives_.by_drive(columns);
    } else {
      to = columns;
    }
  }

 private:
  using Axes = typename LinkTree<Joints, Scalar>::Axes;
  using Drives_ = Drives<N, Joints, Scalar>;

  template <int Length>
  [[nodiscard]] static const auto& checked(const Chain<Scalar, Length>& chain) {
    (void)require_joints(chain);
    return chain;
  }
  template <int Length, int Frames>
  [[nodiscard]] static const auto& checked(const Tree<Scalar, Length, Frames>& tree) {
    (void)require_tree(tree);
    return tree;
  }
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] int number_of(int link) const noexcept { return link == kTip ? tip_link_ : link; }

  /// columns() for a robot with joints that follow others: the column of a drive is a sum over joints.
  template <typename F>
  Vector3 columns_of_drives(const State& state, int link, const Vector3& p, const F& f) const noexcept {
    Matrix<6, Joints, Scalar> J;
    Matrix<6, Joints, Scalar> Jd;
    J.resize(6, joints());
    Jd.resize(6, joints());
    typename Axes::Point point(SplitVector<Scalar>::load(p.data()));
    tree_.each_column(state, number_of(link), point, joint_rates(state),
                      [&](Eigen::Index i, const auto& columns, const auto& rates) noexcept {
                        columns.store(J, i);
                        rates.store(Jd, i);
                      });
    const Matrix<6, N, Scalar> of_drives = drives_.by_drive(J);
    const Matrix<6, N, Scalar> rates_of_drives = drives_.by_drive(Jd);
    for (Eigen::Index i = 0; i < dof(); i += 2) f(i, Columns::load(of_drives, i), Columns::load(rates_of_drives, i));
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
