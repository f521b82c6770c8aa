#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/drives.hpp"
#include "fpbm/model/forward_pass.hpp"
#include "fpbm/model/frame.hpp"
#include "fpbm/model/screws.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// State of a robot, which tasks read: placements in the base frame, and angular velocities in its axes.
/// Robot::update() fills it.
template <int N, typename Scalar = double, int Joints = N>
struct RobotState {
  Vector<N, Scalar> q;   ///< Of the drives [rad] or [m].
  Vector<N, Scalar> qd;  ///< [rad/s] or [m/s]
  /// Of the base and each joint; z is the joint's axis.
  std::array<Vector<3, Scalar>, kCapacity<Joints> + 1> p;
  std::array<Matrix<3, 3, Scalar>, kCapacity<Joints> + 1> R;
  Screws<Joints, Scalar> screws;    ///< Axes of the joints, and how their links turn.
  Vector<Joints, Scalar> joint_qd;  ///< Of all joints, where some follow others.
  bool moves = true;                ///< False: qd was not given, J̇ is not needed.

  RobotState() noexcept {}  // NOLINT(modernize-use-equals-default): braces would set all bytes to 0.

  [[nodiscard]] Transform<Scalar> placement(std::size_t i) const noexcept { return {p[i], R[i]}; }
};

/// A tree of joints, of which N have a drive and others follow them, and whose links tasks refer to. Immutable.
///
/// Link 0 is the base, link i the link that joint i moves, counted from 1, with the joint's frame after its motion.
/// kTip is the tip of a chain. Joints: their number, where it is not N.
template <int N, typename Scalar_ = double, int Joints = N>
class Robot {
 public:
  using Scalar = Scalar_;
  using State = RobotState<N, Scalar, Joints>;
  using Vector3 = Vector<3, Scalar>;
  using Columns = typename Screws<Joints, Scalar>::ColumnPair;  ///< Two columns of J or J̇.
  static constexpr int kDof = N;
  static constexpr int kTip = -1;

  /// Throws std::invalid_argument as require_joints() and Drives do.
  template <int Length = Eigen::Dynamic>
  explicit Robot(const Chain<Scalar, Length>& chain) : pass_(sized(require_joints(chain))), drives_(chain) {
    connect(chain);
    tip_link_ = static_cast<int>(pass_.dof());
    tip_ = ends_[index(tip_link_)] * chain.tip;
    set_length(chain_length(chain, tip_link_) + norm(chain.tip.p));
  }

  /// Throws std::invalid_argument as require_tree() and Drives do.
  template <int Length, int Frames>
  explicit Robot(const Tree<Scalar, Length, Frames>& tree) : pass_(sized(require_tree(tree))), drives_(tree) {
    connect(tree);
    masses_[0] = tree.base;
    Scalar longest(0);
    for (Eigen::Index link = 1; link <= pass_.dof(); ++link) {
      masses_[index(link)] = seen_from_joint(tree.joints[index(link - 1)].moved, link);
      longest = std::max(longest, chain_length(tree, link));
    }
    for (const auto& frame : tree.frames) {
      if (frame.link > 0) longest = std::max(longest, chain_length(tree, frame.link) + norm(frame.offset.p));
    }
    set_length(longest);
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(drives_.count()); }
  /// Number of joints, those that follow others included.
  [[nodiscard]] int joints() const noexcept { return static_cast<int>(pass_.dof()); }
  /// Bounds within which all joints keep theirs.
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return drives_.limits(); }
  /// Characteristic length [m]: of a chain as SerialArm::length(); of a tree that of the longest chain to a frame or a
  /// joint.
  [[nodiscard]] Scalar length() const noexcept { return length_; }
  [[nodiscard]] const Drives<N, Joints, Scalar>& drives() const noexcept { return drives_; }
  /// Whether joint i, counted from 0, turns: otherwise it is prismatic.
  [[nodiscard]] bool turns(Eigen::Index i) const noexcept { return pass_.turns().coeff(i) > Scalar(0); }
  /// Bits of the joints that move a link.
  [[nodiscard]] JointBits moved_by(int link) const noexcept { return moved_by_[index(number_of(link))]; }
  /// Number of the link that carries the joint that moves a link.
  [[nodiscard]] int parent(int link) const noexcept { return parents_[index(number_of(link) - 1)]; }
  /// Mass of a link, and its centre seen from the link's joint.
  [[nodiscard]] const LinkMass<Scalar>& mass(int link) const noexcept { return masses_[index(link)]; }

  /// Throws std::invalid_argument unless link is 0 to joints(), or kTip of a chain.
  void require_link(const char* name, int link) const {
    if (link == kTip && tip_link_ == kTip) {
      validation::fail(name, link, "the number of a link: a tree has no tip, name one of its frames");
    }
    if (link < kTip || link > joints()) {
      validation::fail(name, link, "the number of a link, at most ", joints(),
                       tip_link_ == kTip ? "" : ", or Robot::kTip");
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
    if constexpr (Drives_::kMayFollow) {
      if (drives_.follows()) {
        state.joint_qd = drives_.rates(qd);
        return place(drives_.positions(q), state.joint_qd, state);
      }
    }
    if constexpr (N == Joints) place(q, qd, state);
  }

  /// A frame fixed to a link, at offset in the link's frame, seen from the link's joint. Constant: for the constructor
  /// of what asks for frame() at every tick.
  [[nodiscard]] Transform<Scalar> in_joint(int link, const Transform<Scalar>& offset) const noexcept {
    return (link == kTip ? tip_ : ends_[index(link)]) * offset;
  }
  /// That frame in the base frame. seen: in_joint().
  [[nodiscard]] Transform<Scalar> frame(const State& state, int link, const Transform<Scalar>& seen) const noexcept {
    return state.placement(index(number_of(link))) * seen;
  }

  /// Its axes, the columns. seen: those of in_joint().
  [[nodiscard]] Matrix<3, 3, Scalar> axes(const State& state, int link,
                                          const Matrix<3, 3, Scalar>& seen) const noexcept {
    return times(state.R[index(number_of(link))], seen);
  }
  /// Its origin. seen: in_joint().
  [[nodiscard]] Vector3 point(const State& state, int link, const Vector3& seen) const noexcept {
    const std::size_t joint = index(number_of(link));
    const Vector3 turned = times(state.R[joint], seen);
    return entrywise(turned, [&](Eigen::Index i) { return state.p[joint].coeff(i) + turned.coeff(i); });
  }
  /// Angular velocity of a link, in the base frame's axes [rad/s].
  [[nodiscard]] Vector3 angular_velocity(const State& state, int link) const noexcept {
    const int joint = number_of(link);
    return joint > 0 ? state.screws.angular_velocity(joint - 1) : filled<Vector3>(3);
  }

  /// Calls f(i, columns, rates) with columns i and i + 1 of J and of J̇, in the base frame's axes, of a point p of a
  /// link: linear rows [m] and angular ones [rad]. Returns the velocity of the point [m/s].
  ///
  /// Column i of J is [l; a] = [z × (p − pᵢ); z] for a joint that turns, [z; 0] for one that slides. That of J̇ is
  /// [wᵢ × l + a × uᵢ; wᵢ × a], where uᵢ = Σ_{j>i} q̇ⱼ lⱼ (docs/equations.md). Columns of joints beyond the link, and J̇
  /// of a state without velocities, are 0.
  template <typename F>
  [[gnu::always_inline]] Vector3 columns(const State& state, int link, const Vector3& p, const F& f) const noexcept {
    if constexpr (Drives_::kMayFollow) {
      if (drives_.follows()) return columns_of_drives(state, link, p, f);
    }
    typename Axes::Point point(SplitVector<Scalar>::load(p.data()));
    each_column(state, link, point, joint_rates(state), f);
    return point.velocity();
  }

  /// The same of the angular rows alone.
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
    const bool slides = pass_.slides();
    each_pair(state, link, [&](Eigen::Index i, const typename Axes::JointPair& joints) noexcept {
      const auto columns = Axes::angular_columns(i, joints, pass_.turns(), slides);
      f(i, columns, Axes::angular_rates(joints, columns));
    });
  }

  /// J and J̇ of a point p of a link, as columns(), as matrices: linear rows, or linear and then angular ones. Returns
  /// the velocity of the point.
  template <int M>
  Vector3 jacobian(const State& state, int link, const Vector3& p, Matrix<M, N, Scalar>& J,
                   Matrix<M, N, Scalar>& Jd) const noexcept {
    static_assert(M == 3 || M == 6, "a frame has 3 linear rows, and 3 angular ones");
    J.resize(M, dof());
    Jd.resize(M, dof());
    return columns(state, link, p, [&](Eigen::Index i, const auto& columns, const auto& rates) noexcept {
      columns.store(J, i);
      rates.store(Jd, i);
    });
  }

  /// Rates of all joints in a state [rad/s] or [m/s].
  [[nodiscard]] const Vector<Joints, Scalar>& joint_rates(const State& state) const noexcept {
    if constexpr (N == Joints) {
      return drives_.follows() ? state.joint_qd : state.qd;
    } else {
      return state.joint_qd;
    }
  }
  /// Columns for the drives from those for all joints.
  template <int M>
  void set_by_drive(const Matrix<M, Joints, Scalar>& columns, Matrix<M, N, Scalar>& to) const noexcept {
    if constexpr (Drives_::kMayFollow) {
      to = drives_.by_drive(columns);
    } else {
      to = columns;
    }
  }

 private:
  using Axes = Screws<Joints, Scalar>;
  using Drives_ = Drives<N, Joints, Scalar>;
  using JointVector = Vector<Joints, Scalar>;

  /// Stores the joints' placements in a state.
  struct Storing {
    Storing(const Robot& robot_, State& state_) noexcept : robot(robot_), state(state_) {}

    const Robot& robot;
    State& state;

    static void enter(Eigen::Index, Frame<Scalar>&, SplitVector<Scalar>&) noexcept {}
    void leave(Eigen::Index i, const Frame<Scalar>& frame) const noexcept {
      frame.store(state.p[index(i + 1)], state.R[index(i + 1)]);
    }
  };
  /// And continues from there at joints that are not carried by the link of the joint before.
  struct StoringTree : Storing {
    using Storing::Storing;

    void enter(Eigen::Index i, Frame<Scalar>& frame, SplitVector<Scalar>& w) const noexcept {
      if ((this->robot.branches_ >> i & 1U) == 0) return;
      const int parent = this->robot.parents_[index(i)];
      frame = Frame<Scalar>(this->state.placement(index(parent)) * this->robot.starts_[index(i)]);
      const Vector3 turning = this->robot.angular_velocity(this->state, parent);
      w = SplitVector<Scalar>::load(turning.data());
    }
  };

  [[nodiscard]] static Eigen::Index sized(Eigen::Index joints) {
    if constexpr (Joints != Eigen::Dynamic) validation::require_size("joints", joints, Joints);
    return joints;
  }
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] int number_of(int link) const noexcept { return link == kTip ? tip_link_ : link; }

  void place(const JointVector& q, const JointVector& qd, State& state) const noexcept {
    branches_ == 0 ? place<Storing>(q, qd, state) : place<StoringTree>(q, qd, state);
  }
  template <typename Along>
  void place(const JointVector& q, const JointVector& qd, State& state) const noexcept {
    pass_.slides() ? place<Along, true>(q, qd, state) : place<Along, false>(q, qd, state);
  }
  template <typename Along, bool kSlides>
  [[gnu::flatten, gnu::noinline]] void place(const JointVector& q, const JointVector& qd, State& state) const noexcept {
    (void)pass_.template operator()<true, kSlides>(starts_[0], q, qd, state.screws, Along(*this, state));
  }

  /// Calls f(i, joints) with joints i and i + 1, the last first; those that do not move the link have no axis.
  template <typename F>
  [[gnu::always_inline]] void each_pair(const State& state, int link, const F& f) const noexcept {
    const auto pairs = pairs_of(extent<Joints>(pass_.dof()));
    const JointBits moving = moved_by(link);
    if (moving == all_) {
      each(Constant<0>{}, pairs, [&](auto k) noexcept {
        const Eigen::Index i = 2 * (pairs - 1 - Eigen::Index(k));
        f(i, state.screws.joints(i));
      });
      return;
    }
    for (Eigen::Index i = 2 * (pairs - 1); i >= 0; i -= 2) f(i, state.screws.joints(i).only(moving >> i));
  }

  template <typename F>
  [[gnu::always_inline]] void each_column(const State& state, int link, typename Axes::Point& point,
                                          const JointVector& qd, const F& f) const noexcept {
    const bool slides = pass_.slides();
    each_pair(state, link, [&](Eigen::Index i, const typename Axes::JointPair& joints) noexcept {
      const auto columns = Axes::columns(i, joints, point, pass_.turns(), slides);
      f(i, columns, state.moves ? Axes::rates(i, joints, columns, point, qd) : Axes::ColumnPair::zero());
    });
  }

  /// As columns(), of a robot with joints that follow others: each column of a drive is a sum over joints.
  template <typename F>
  Vector3 columns_of_drives(const State& state, int link, const Vector3& p, const F& f) const noexcept {
    Matrix<6, Joints, Scalar> J;
    Matrix<6, Joints, Scalar> Jd;
    J.resize(6, joints());
    Jd.resize(6, joints());
    typename Axes::Point point(SplitVector<Scalar>::load(p.data()));
    each_column(state, link, point, joint_rates(state),
                [&](Eigen::Index i, const auto& columns, const auto& rates) noexcept {
                  columns.store(J, i);
                  rates.store(Jd, i);
                });
    const Matrix<6, N, Scalar> of_drives = drives_.by_drive(J);
    const Matrix<6, N, Scalar> rates_of_drives = drives_.by_drive(Jd);
    for (Eigen::Index i = 0; i < dof(); i += 2) f(i, Columns::load(of_drives, i), Columns::load(rates_of_drives, i));
    return point.velocity();
  }

  /// Sets the constants of all joints, each behind the link that carries it.
  template <typename Source>
  void connect(const Source& source) {
    for (Eigen::Index i = 0; i < pass_.dof(); ++i) {
      const auto& joint = joint_of(source, i);
      const int parent = parent_of(source, i);
      Transform<Scalar> to_axis;
      to_axis.R = z_to(joint.axis);
      const Transform<Scalar> step = ends_[index(parent)] * joint.placement * to_axis;
      if (i > 0 && parent == i) {
        const Scalar before = pass_.connect(i - 1, step).before;
        ends_[index(parent)].R = times(rotation(Vector3(Scalar(0), Scalar(0), -before)), ends_[index(parent)].R);
      } else {
        starts_[index(i)] = step;
        if (i > 0) branches_ |= joint_bit(i);
      }
      if (joint.type == JointType::kPrismatic) pass_.set_prismatic(i);
      parents_[index(i)] = parent;
      ends_[index(i + 1)].R = transposed(to_axis.R);
      moved_by_[index(i + 1)] = moved_by_[index(parent)] | joint_bit(i);
      all_ |= joint_bit(i);
    }
  }

  /// Length of the chain from the first joint that moves a link to the link's own joint [m]. Finite ranges of prismatic
  /// joints are added.
  template <typename Source>
  [[nodiscard]] Scalar chain_length(const Source& source, Eigen::Index link) const {
    Scalar length(0);
    while (link > 0) {
      const auto& joint = joint_of(source, link - 1);
      const Scalar range = joint.bounds.upper - joint.bounds.lower;
      if (joint.type == JointType::kPrismatic && std::isfinite(range)) length += range;
      link = parent_of(source, link - 1);
      if (link > 0) length += norm(joint.placement.p);
    }
    return length;
  }
  [[nodiscard]] LinkMass<Scalar> seen_from_joint(const LinkMass<Scalar>& mass, Eigen::Index link) const {
    return {mass.mass, times(ends_[index(link)].R, mass.centre)};
  }
  void set_length(Scalar length) noexcept { length_ = length > Scalar(0) ? length : Scalar(1); }

  static constexpr std::size_t kLinks = static_cast<std::size_t>(kCapacity<Joints>) + 1;
  ForwardPass<Joints, Scalar> pass_;
  Drives_ drives_;
  JointBits all_ = 0;
  JointBits branches_ = 0;  ///< Of joints, but the first, that are not carried by the link of the joint before.
  std::array<int, kLinks> parents_{};             ///< Of each joint, the link that carries it.
  std::array<JointBits, kLinks> moved_by_{};      ///< Of each link, the joints that move it.
  std::array<Transform<Scalar>, kLinks> starts_;  ///< Of these joints at zero, from the placement of what carries them.
  std::array<Transform<Scalar>, kLinks> ends_;    ///< From a joint's placement to its link's frame.
  std::array<LinkMass<Scalar>, kLinks> masses_;
  int tip_link_ = kTip;
  Transform<Scalar> tip_;  ///< From the last joint's placement.
  Scalar length_{1};       ///< [m]
};

}  // namespace fpbm
