#pragma once

#include <array>
#include <type_traits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/geometry/detail/sincos.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/model/detail/frame.hpp"
#include "fpbm/model/detail/link.hpp"
#include "fpbm/model/detail/screws.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Constants of N joints. The forward pass moves a frame from joint to joint and computes the axes of the joints.
///
/// The frame of joint i has the axis of the joint as z. The pass moves from one joint to the next by a translation and
/// a tilt (DecomposedLink). The rotations about z before and after the tilt are offsets of the angles of the two
/// joints.
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
  /// Whether any joint is prismatic.
  [[nodiscard]] bool slides() const noexcept { return slides_ != 0; }
  /// 1 for each revolute joint, 0 for each prismatic joint.
  [[nodiscard]] const Vector<N, Scalar>& turns() const noexcept { return turns_; }

  void set_prismatic(Eigen::Index i) noexcept {
    turns_(i) = Scalar(0);
    slides_ |= joint_bit(i);
  }

  /// Sets the transform from the frame of joint i to the frame of joint i + 1, both at position zero. Returns the
  /// decomposed transform. The pass adds the angle `before` to the angle of joint i, and `after` to the angle of joint
  /// i + 1.
  DecomposedLink<Scalar> connect(Eigen::Index i, const Transform<Scalar>& step) {
    const DecomposedLink<Scalar> between(step);
    links_[static_cast<std::size_t>(i)] = LinkPassage<Scalar>(between.link);
    offsets_(i) += between.before;
    if (i + 1 < dof_) offsets_(i + 1) += between.after;
    return between;
  }

  /// Computes the axes of the joints at (q, qd), starting from the frame of the first joint at position zero. For each
  /// joint, calls along.enter(i, frame, w) before the motion of the joint, and along.leave(i, frame) after the motion.
  /// enter() may set the frame and the angular velocity w. Returns the frame at the end of the last link.
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
    SplitVector<Scalar> w;  // Angular velocity of the frame [rad/s].
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

  /// Number of joints, known at compile time if loops are unrolled. Loops over chains with prismatic joints are not
  /// unrolled: unrolled loops would take as long to compile as the loops over all other chains.
  template <bool kSlides>
  [[nodiscard]] auto joints() const noexcept {
    return extent < kSlides ? Eigen::Dynamic : N > (dof_);
  }

 private:
  template <int, typename>
  friend class ForwardPass;

  [[nodiscard]] bool slides(Eigen::Index i) const noexcept { return (slides_ >> i & 1U) != 0; }

  Eigen::Index dof_;
  std::array<LinkPassage<Scalar>, kCapacity<N>> links_;  ///< From the frame of each joint to the next frame.
  Vector<N, Scalar> turns_;  ///< 1, or 0 for a prismatic joint: the angle of a frame is turns q + offset.
  Vector<N, Scalar> offsets_;
  JointBits slides_ = 0;  ///< Bits of the prismatic joints.
};

/// For chains: the link of each joint carries the next joint, and no placement is stored.
struct AlongChain {
  template <typename Frame, typename Vector>
  static void enter(Eigen::Index, Frame&, Vector&) noexcept {}
  template <typename Frame>
  static void leave(Eigen::Index, const Frame&) noexcept {}
};

}  // namespace fpbm
