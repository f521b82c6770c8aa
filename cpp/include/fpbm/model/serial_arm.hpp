#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/sincos.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/core/unrolled.hpp"
#include "fpbm/linalg/pair.hpp"
#include "fpbm/linalg/sums.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/frame.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/model/link.hpp"
#include "fpbm/model/screws.hpp"

namespace fpbm {

/// Any chain of N revolute, continuous and prismatic joints, in space. Immutable.
///
/// Joint positions in radians or metres; the first joint's placement is given in the base frame.
/// N = Eigen::Dynamic takes the number of joints from the chain, up to kMaxDof.
template <int N, typename Scalar_ = double>
class SerialArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// Throws std::invalid_argument where the number of joints is not N or exceeds kMaxDof, an axis is zero, a number is
  /// not finite, a placement's R is no rotation, or a joint's lower bound is not below its upper.
  template <int Length = Eigen::Dynamic>
  explicit SerialArm(const Chain<Scalar, Length>& chain)
      : dof_(require_chain(chain, N)), limits_(JointLimits<N, Scalar>::none(dof_)) {
    turns_ = filled<Vector<N, Scalar>>(dof_, Scalar(1));
    offsets_ = filled<Vector<N, Scalar>>(dof_);
    Transform<Scalar> turned_back;
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const auto& joint = chain.joints[static_cast<std::size_t>(i)];
      const Matrix<3, 3, Scalar> to_axis = z_to(joint.axis);
      Transform<Scalar> step = turned_back * joint.placement;
      step.R = times(step.R, to_axis);
      turned_back.R = transposed(to_axis);
      if (i == 0) {
        base_ = step;
      } else {
        const DecomposedLink<Scalar> between(step);
        links_[static_cast<std::size_t>(i - 1)] = LinkPassage<Scalar>(between.link);
        offsets_(i - 1) += between.before;
        offsets_(i) = between.after;
      }
      if (joint.type == JointType::kPrismatic) {
        turns_(i) = Scalar(0);
        slides_ |= std::uint32_t(1) << i;
        const Scalar range = joint.bounds.upper - joint.bounds.lower;
        if (std::isfinite(range)) length_ += range;
      }
      if (i > 0) length_ += norm(joint.placement.p);
      limits_.set(i, joint.bounds);
    }
    length_ += norm(chain.tip.p);
    if (!(length_ > Scalar(0))) length_ = Scalar(1);
    const DecomposedLink<Scalar> last(turned_back * chain.tip);
    links_[static_cast<std::size_t>(dof_ - 1)] = LinkPassage<Scalar>(last.link);
    offsets_(dof_ - 1) += last.before;
    using std::cos;
    using std::sin;
    tip_ = {Twice<Scalar>(cos(last.after)), Twice<Scalar>(sin(last.after))};
  }

  /// The same arm for another Scalar.
  template <typename Other>
  [[nodiscard]] SerialArm<N, Other> cast() const {
    return SerialArm<N, Other>(*this);
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(dof_); }
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return limits_; }

  /// Characteristic length [m]: the way from the first joint to the tip, from joint to joint, with the finite ranges of
  /// prismatic joints. 1 where that is zero.
  [[nodiscard]] Scalar length() const noexcept { return length_; }

  /// Whether a joint is prismatic.
  [[nodiscard]] bool slides() const noexcept { return slides_ != 0; }
  /// 1 for each joint that turns, 0 for a prismatic one.
  [[nodiscard]] const Vector<N, Scalar>& turns() const noexcept { return turns_; }

  /// Axes of the joints at (q, qd). Calls visit(i, frame) for each joint i, from the base on, with a frame that joint i
  /// moves and whose z axis is the joint's: it differs from the joint's frame by a constant rotation about z.
  template <typename Visit>
  void place(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd, Screws<N, Scalar>& axes,
             const Visit& visit) const noexcept {
    slides_ == 0 ? place<false>(q, qd, axes, visit) : place<true>(q, qd, axes, visit);
  }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<3> and Pose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    slides_ == 0 ? forward_pass<true, false>(q, qd, out) : forward_pass<true, true>(q, qd, out);
  }

  /// Tip and J at q; does not touch Jd.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    slides_ == 0 ? forward_pass<false, false>(q, q, out) : forward_pass<false, true>(q, q, out);
  }

 private:
  template <int, typename>
  friend class SerialArm;

  template <typename Other>
  explicit SerialArm(const SerialArm<N, Other>& arm)
      : dof_(arm.dof_),
        base_(arm.base_.template cast<Scalar>()),
        turns_(arm.turns_.template cast<Scalar>()),
        offsets_(arm.offsets_.template cast<Scalar>()),
        slides_(arm.slides_),
        tip_(arm.tip_.template cast<Scalar>()),
        length_(static_cast<Scalar>(arm.length_)),
        limits_(arm.limits_.template cast<Scalar>()) {
    for (std::size_t i = 0; i < links_.size(); ++i) links_[i] = arm.links_[i].template cast<Scalar>();
  }

  using Vector3 = Vector<3, Scalar>;

  [[nodiscard]] bool slides(Eigen::Index i) const noexcept { return (slides_ >> i & 1U) != 0; }

  /// Number of joints, known at compile time where loops are unrolled. Of an arm with joints that slide in a loop:
  /// unrolled, it would take as long to compile as that of all others.
  template <bool kSlides>
  [[nodiscard]] auto joints() const noexcept {
    return extent < kSlides ? Eigen::Dynamic : N > (dof_);
  }

  /// A pass along the chain finds the joints' axes. Returns the frame at the end of the last link.
  template <bool kWithRate, bool kSlides, typename Visit>
  [[gnu::always_inline]] Frame<Scalar> pass(const Vector<N, Scalar>& q, [[maybe_unused]] const Vector<N, Scalar>& qd,
                                            Screws<N, Scalar>& axes, const Visit& visit) const noexcept {
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

    Frame<Scalar> frame(base_);
    SplitVector<Scalar> w;  // Angular velocity of the frame.
    each(Constant<0>{}, pairs, [&](auto k) {
      Joint joints[2];
      const Eigen::Index i = 2 * Eigen::Index(k);
      for (Eigen::Index j = i; j < i + 2 && j < n; ++j) {
        if (kSlides && slides(j)) {
          frame.p += Two(q.coeff(j)) * frame.z;
        } else if constexpr (kWithRate) {
          w += Two(qd.coeff(j)) * frame.z;
        }
        joints[j - i] = {frame.z, frame.p, w};
        frame.turn(Two(cosines.coeff(j)), Two(sines.coeff(j)));
        visit(j, frame);
        frame.pass(links_[static_cast<std::size_t>(j)]);
      }
      axes.set(i, joints[0], joints[1]);
    });
    return frame;
  }

  /// As the public place(), for chains without prismatic joints, or for the others.
  template <bool kSlides, typename Visit>
  [[gnu::flatten, gnu::noinline]] void place(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                                             Screws<N, Scalar>& axes, const Visit& visit) const noexcept {
    (void)pass<true, kSlides>(q, qd, axes, visit);
  }

  /// Tip, J and Jd. One function serves chains without prismatic joints, another serves the others.
  template <bool kWithRate, bool kSlides, typename Space>
  [[gnu::flatten, gnu::noinline]] void forward_pass(const Vector<N, Scalar>& q,
                                                    [[maybe_unused]] const Vector<N, Scalar>& qd,
                                                    Kinematics<Space, N, Scalar>& out) const noexcept {
    constexpr bool kWithOrientation = std::is_same_v<Space, Pose>;
    static_assert(kWithOrientation || std::is_same_v<Space, Position<3>>,
                  "a serial arm has tasks Position<3> and Pose");
    using Axes = Screws<N, Scalar>;
    // One object: g++ keeps its members in memory. A separate tip would take registers that the columns need, 3 % of
    // the kinematics' instructions (make count).
    struct Pass {
      Axes axes;
      typename Axes::Point tip{{}};
    } at;
    Frame<Scalar> frame = pass<kWithRate, kSlides>(q, qd, at.axes, [](Eigen::Index, const Frame<Scalar>&) noexcept {});
    const auto n = joints<kSlides>();
    const auto pairs = pairs_of(n);

    out.length = length_;
    if constexpr (kWithOrientation) {
      frame.turn(tip_.cosine.pair(), tip_.sine.pair());
      frame.store(out.tip.p, out.tip.R);
    } else {
      frame.p.store(out.tip.data());
    }
    out.J.resize(Space::kRows, n);
    if constexpr (kWithRate) out.Jd.resize(Space::kRows, n);
    at.tip = typename Axes::Point(frame.p);
    each(Constant<0>{}, pairs, [&](auto k) {
      const Eigen::Index i = 2 * (pairs - 1 - Eigen::Index(k));
      const auto columns = Axes::columns(i, at.axes.joints(i), at.tip, turns_, kSlides);
      columns.store(out.J, i);
      if constexpr (kWithRate) Axes::rates(i, at.axes.joints(i), columns, at.tip, qd).store(out.Jd, i);
    });
  }

  Eigen::Index dof_;
  Transform<Scalar> base_;                               ///< The first joint's frame at zero.
  std::array<LinkPassage<Scalar>, kCapacity<N>> links_;  ///< From each joint's frame to the next.
  Vector<N, Scalar> turns_;  ///< 1, or 0 for a prismatic joint: a frame's angle is turns q + offset.
  Vector<N, Scalar> offsets_;
  std::uint32_t slides_ = 0;  ///< Bit i is set where joint i is prismatic.
  FixedTurn<Scalar> tip_;     ///< About z, from the frame of the last link's end to the tip's.
  Scalar length_{0};          ///< [m]
  JointLimits<N, Scalar> limits_;
};

}  // namespace fpbm
