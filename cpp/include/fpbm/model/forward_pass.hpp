#pragma once

#include <array>
#include <type_traits>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/sincos.hpp"
#include "fpbm/core/unrolled.hpp"
#include "fpbm/linalg/pair.hpp"
#include "fpbm/model/frame.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/link.hpp"
#include "fpbm/model/screws.hpp"

namespace fpbm {

/// The constants of N joints, and the pass of a frame from joint to joint, which finds their axes.
///
/// The frame of joint i has the joint's axis as z. The pass goes from one joint to the next by a step and a tilt
/// (DecomposedLink); rotations about z before and after the tilt are added to the angles of the joints on either side.
template <int N, typename Scalar>
class ForwardPass {
 public:
  explicit ForwardPass(Eigen::Index dof)
      : dof_(dof), turns_(filled<Vector<N, Scalar>>(dof, Scalar(1))), offsets_(filled<Vector<N, Scalar>>(dof)) {
    for (auto& link : links_) link = LinkPassage<Scalar>({filled<Vector<3, Scalar>>(3), Scalar(1), Scalar(0)});
  }

  template <typename Other>
  explicit ForwardPass(const ForwardPass<N, Other>& pass)
      : dof_(pass.dof_),
        turns_(pass.turns_.template cast<Scalar>()),
        offsets_(pass.offsets_.template cast<Scalar>()),
        slides_(pass.slides_) {
    for (std::size_t i = 0; i < links_.size(); ++i) links_[i] = pass.links_[i].template cast<Scalar>();
  }

  [[nodiscard]] Eigen::Index dof() const noexcept { return dof_; }
  /// Whether a joint is prismatic.
  [[nodiscard]] bool slides() const noexcept { return slides_ != 0; }
  /// 1 for each joint that turns, 0 for a prismatic one.
  [[nodiscard]] const Vector<N, Scalar>& turns() const noexcept { return turns_; }

  void set_prismatic(Eigen::Index i) noexcept {
    turns_(i) = Scalar(0);
    slides_ |= joint_bit(i);
  }

  /// Sets the step from the frame of joint i to that of joint i + 1 at zero. Returns its parts: the frame of joint i is
  /// ahead of its own by `before`, that of joint i + 1 by `after`.
  DecomposedLink<Scalar> connect(Eigen::Index i, const Transform<Scalar>& step) {
    const DecomposedLink<Scalar> between(step);
    links_[static_cast<std::size_t>(i)] = LinkPassage<Scalar>(between.link);
    offsets_(i) += between.before;
    if (i + 1 < dof_) offsets_(i + 1) += between.after;
    return between;
  }

  /// Finds the joints' axes at (q, qd), from the frame of the first joint at zero on. `along` is told of each joint:
  /// enter(i, frame, w) before its motion, where it may set the frame and the angular velocity, and leave(i, frame)
  /// after. Returns the frame at the end of the last link.
  template <bool kWithRate, bool kSlides, typename Along>
  [[gnu::always_inline]] Frame<Scalar> operator()(const Transform<Scalar>& first, const Vector<N, Scalar>& q,
                                                  [[maybe_unused]] const Vector<N, Scalar>& qd, Screws<N, Scalar>& axes,
                                                  const Along& along) const noexcept {
    using Two = Pair<Scalar>;
    using Joint = typename Screws<N, Scalar>::Joint;
    const auto n = joints<kSlides>();
    const auto pairs = pairs_of(n);
    Angles<N, Scalar> angles = angles_of<N, Scalar>(extent<N>(dof_));
    each(Constant<0>{}, pairs, [&](auto k) {
      const Eigen::Index i = 2 * Eigen::Index(k);
      const Two turned = kSlides ? two_of(turns_, i) * two_of(q, i) : two_of(q, i);
      set_two_of(angles, i, turned + two_of(offsets_, i));
    });
    Angles<N, Scalar> sines;
    Angles<N, Scalar> cosines;
    sincos(angles, sines, cosines);

    Frame<Scalar> frame(first);
    SplitVector<Scalar> w;  // Angular velocity of the frame.
    each(Constant<0>{}, pairs, [&](auto k) {
      Joint joints[2];
      const Eigen::Index i = 2 * Eigen::Index(k);
      for (Eigen::Index j = i; j < i + 2 && j < n; ++j) {
        along.enter(j, frame, w);
        if (kSlides && slides(j)) {
          frame.p += Two(q.coeff(j)) * frame.z;
        } else if constexpr (kWithRate) {
          w += Two(qd.coeff(j)) * frame.z;
        }
        joints[j - i] = {frame.z, frame.p, w};
        frame.turn(Two(cosines.coeff(j)), Two(sines.coeff(j)));
        along.leave(j, frame);
        frame.pass(links_[static_cast<std::size_t>(j)]);
      }
      axes.set(i, joints[0], joints[1]);
    });
    return frame;
  }

  /// Number of joints, known at compile time where loops are unrolled. Of joints that slide in a loop: unrolled, it
  /// would take as long to compile as that of all others.
  template <bool kSlides>
  [[nodiscard]] auto joints() const noexcept {
    return extent < kSlides ? Eigen::Dynamic : N > (dof_);
  }

 private:
  template <int, typename>
  friend class ForwardPass;

  [[nodiscard]] bool slides(Eigen::Index i) const noexcept { return (slides_ >> i & 1U) != 0; }

  Eigen::Index dof_;
  std::array<LinkPassage<Scalar>, kCapacity<N>> links_;  ///< From each joint's frame to the next.
  Vector<N, Scalar> turns_;  ///< 1, or 0 for a prismatic joint: a frame's angle is turns q + offset.
  Vector<N, Scalar> offsets_;
  JointBits slides_ = 0;  ///< Of prismatic joints.
};

/// All joints carried by the joint before.
struct AlongChain {
  template <typename Frame, typename Vector>
  static void enter(Eigen::Index, Frame&, Vector&) noexcept {}
  template <typename Frame>
  static void leave(Eigen::Index, const Frame&) noexcept {}
};

}  // namespace fpbm
