#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/detail/forward_pass.hpp"
#include "fpbm/model/detail/robot_state.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// Constants of a tree of joints: the link that carries each joint, and the placement of the joint. Computes the
/// placements of a RobotState, and the columns of J and J̇ for the joints.
template <int Joints, typename Scalar>
class LinkTree {
 public:
  using JointVector = Vector<Joints, Scalar>;
  using Vector3 = Vector<3, Scalar>;
  using Axes = Screws<Joints, Scalar>;
  using Columns = typename Axes::ColumnPair;

  /// joints: result of require_tree() or require_joints() for the source. Throws std::invalid_argument if the number of
  /// joints is not Joints.
  template <typename Source>
  LinkTree(const Source& source, Eigen::Index joints) : pass_(checked(joints)) {
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

  [[nodiscard]] int joints() const noexcept { return static_cast<int>(pass_.dof()); }
  /// Whether joint i, counted from 0, is revolute, and not prismatic.
  [[nodiscard]] bool turns(Eigen::Index i) const noexcept { return pass_.turns().coeff(i) > Scalar(0); }
  /// Bits of the joints that move a link.
  [[nodiscard]] JointBits moved_by(int link) const noexcept { return moved_by_[index(link)]; }
  /// Number of the parent link: the link that carries the joint of `link`.
  [[nodiscard]] int parent(int link) const noexcept { return parents_[index(link - 1)]; }
  /// Frame of a link, relative to the placement of its joint.
  [[nodiscard]] const Transform<Scalar>& end(int link) const noexcept { return ends_[index(link)]; }

  /// Sets the placements and the screws of a state from the positions q and the velocities qd of all joints.
  template <typename State>
  void place(const JointVector& q, const JointVector& qd, State& state) const noexcept {
    state.p[0] = filled<Vector3>(3);
    state.R[0] = identity<Matrix<3, 3, Scalar>>();
    branches_ == 0 ? place<Storing<State>>(q, qd, state) : place<StoringTree<State>>(q, qd, state);
  }

  /// Calls f(i, columns, rates) with columns i and i + 1 of J and J̇ of a point of a link, for all joints.
  template <typename State, typename F>
  [[gnu::always_inline]] void each_column(const State& state, int link, typename Axes::Point& point,
                                          const JointVector& qd, const F& f) const noexcept {
    const bool slides = pass_.slides();
    each_pair(
        state, link,
        [&](Eigen::Index i, const typename Axes::JointPair& joints) noexcept {
          const auto columns = Axes::columns(i, joints, point, pass_.turns(), slides);
          f(i, columns, state.moves ? Axes::rates(i, joints, columns, point, qd) : Columns::zero());
        },
        [&](Eigen::Index i) noexcept { f(i, Columns::zero(), Columns::zero()); });
  }

  /// each_column() for the angular rows only.
  template <typename State, typename F>
  [[gnu::always_inline]] void each_angular_column(const State& state, int link, const F& f) const noexcept {
    const bool slides = pass_.slides();
    const auto angular = [&](Eigen::Index i, const typename Axes::JointPair& joints) noexcept {
      const auto columns = Axes::angular_columns(i, joints, pass_.turns(), slides);
      f(i, columns, Axes::angular_rates(joints, columns));
    };
    each_pair(state, link, angular, [&](Eigen::Index i) noexcept { angular(i, state.screws.joints(i).only(0)); });
  }

 private:
  /// Callbacks of the forward pass that store the placements in a state.
  template <typename State>
  struct Storing {
    Storing(const LinkTree& tree_, State& state_) noexcept : tree(tree_), state(state_) {}

    const LinkTree& tree;
    State& state;

    static void enter(Eigen::Index, Frame<Scalar>&, SplitVector<Scalar>&) noexcept {}
    void leave(Eigen::Index i, const Frame<Scalar>& frame) const noexcept {
      frame.store(state.p[index(i + 1)], state.R[index(i + 1)]);
    }
  };
  /// Storing for trees: at a branch, the pass continues from the stored placement of the link that carries the joint.
  template <typename State>
  struct StoringTree : Storing<State> {
    using Storing<State>::Storing;

    void enter(Eigen::Index i, Frame<Scalar>& frame, SplitVector<Scalar>& w) const noexcept {
      if ((this->tree.branches_ >> i & 1U) == 0) return;
      const int parent = this->tree.parents_[index(i)];
      frame = Frame<Scalar>(this->state.placement(index(parent)) * this->tree.starts_[index(i)]);
      const Vector3 turning = this->state.angular_velocity(parent);
      w = SplitVector<Scalar>::load(turning.data());
    }
  };

  template <typename Along, typename State>
  void place(const JointVector& q, const JointVector& qd, State& state) const noexcept {
    pass_.slides() ? place<Along, true>(q, qd, state) : place<Along, false>(q, qd, state);
  }
  template <typename Along, bool kSlides, typename State>
  [[gnu::flatten, gnu::noinline]] void place(const JointVector& q, const JointVector& qd, State& state) const noexcept {
    (void)pass_.template operator()<true, kSlides>(starts_[0], q, qd, state.screws, Along(*this, state));
  }

  /// Calls f(i, joints) with joints i and i + 1, from the last pair to the first. A joint that does not move the link
  /// has a zero axis. If neither joint of a pair moves the link, calls still(i).
  template <typename State, typename F, typename Still>
  [[gnu::always_inline]] void each_pair(const State& state, int link, const F& f, const Still& still) const noexcept {
    const auto pairs = pairs_of(extent<Joints>(pass_.dof()));
    const JointBits moving = moved_by(link);
    if (moving == all_) {
      each(Constant<0>{}, pairs, [&](auto k) noexcept {
        const Eigen::Index i = 2 * (pairs - 1 - Eigen::Index(k));
        f(i, state.screws.joints(i));
      });
      return;
    }
    for (Eigen::Index i = 2 * (pairs - 1); i >= 0; i -= 2) {
      (moving >> i & 3U) != 0 ? f(i, state.screws.joints(i).only(moving >> i)) : still(i);
    }
  }

  [[nodiscard]] static Eigen::Index checked(Eigen::Index joints) {
    if constexpr (Joints != Eigen::Dynamic) validation::require_size("joints", joints, Joints);
    return joints;
  }
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }

  static constexpr std::size_t kLinks = static_cast<std::size_t>(kCapacity<Joints>) + 1;
  ForwardPass<Joints, Scalar> pass_;
  JointBits all_ = 0;
  JointBits branches_ = 0;  ///< Bits of the joints that start a branch: the previous link does not carry them.
  std::array<int, kLinks> parents_{};         ///< Number of the link that carries each joint.
  std::array<JointBits, kLinks> moved_by_{};  ///< Bits of the joints that move each link.
  std::array<Transform<Scalar>, kLinks>
      starts_;  ///< Frames at zero of the first joint and of branches, in the placement of the parent.
  std::array<Transform<Scalar>, kLinks> ends_;  ///< Frame of each link, relative to the placement of its joint.
};

/// Length of the chain from the first joint that moves a link to the joint of the link [m], plus the finite ranges of
/// prismatic joints. source: a Tree or a Chain.
template <typename Scalar, typename Source>
[[nodiscard]] Scalar chain_length(const Source& source, Eigen::Index link) {
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

/// Length of the longest chain to a joint or a frame of a tree [m].
template <typename Scalar, typename Tree_>
[[nodiscard]] Scalar longest_chain(const Tree_& tree) {
  Scalar longest(0);
  for (std::size_t link = 1; link <= tree.joints.size(); ++link) {
    longest = std::max(longest, chain_length<Scalar>(tree, static_cast<Eigen::Index>(link)));
  }
  for (const auto& [name, link, offset] : tree.frames) {
    if (link > 0) longest = std::max(longest, chain_length<Scalar>(tree, link) + norm(offset.p));
  }
  return longest;
}

}  // namespace fpbm
