#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/geometry/detail/sincos.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/detail/continuous_joints.hpp"
#include "fpbm/model/detail/forward_pass.hpp"
#include "fpbm/model/detail/frame.hpp"
#include "fpbm/model/detail/link.hpp"
#include "fpbm/model/detail/screws.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Chain of N revolute, continuous and prismatic joints in space. Immutable.
///
/// Joint positions are in radians or metres. The placement of the first joint is given in the base frame.
/// With N = Eigen::Dynamic, the chain determines the number of joints, up to kMaxDof.
template <int N, typename Scalar_ = double>
class SerialArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// Throws std::invalid_argument if the number of joints is not N, a joint follows another joint, or require_joints()
  /// rejects the chain.
  template <int Length = Eigen::Dynamic>
  explicit SerialArm(const Chain<Scalar, Length>& chain)
      : pass_(require_chain(chain, N)), limits_(JointLimits<N, Scalar>::none(pass_.dof())) {
    const Eigen::Index dof = pass_.dof();
    Transform<Scalar> turned_back;
    for (Eigen::Index i = 0; i < dof; ++i) {
      const auto& joint = chain.joints[static_cast<std::size_t>(i)];
      const Matrix<3, 3, Scalar> to_axis = z_to(joint.axis);
      Transform<Scalar> step = turned_back * joint.placement;
      step.R = times(step.R, to_axis);
      turned_back.R = transposed(to_axis);
      if (i == 0) {
        base_ = step;
      } else {
        pass_.connect(i - 1, step);
      }
      if (joint.type == JointType::kPrismatic) {
        pass_.set_prismatic(i);
        const Scalar range = joint.bounds.upper - joint.bounds.lower;
        if (std::isfinite(range)) length_ += range;
      }
      if (i > 0) length_ += norm(joint.placement.p);
      limits_.set(i, joint.bounds);
      if (is_continuous(joint.type, joint.bounds)) limits_.continuous |= joint_bit(i);
    }
    length_ += norm(chain.tip.p);
    if (!(length_ > Scalar(0))) length_ = Scalar(1);
    using std::cos;
    using std::sin;
    const Scalar after = pass_.connect(dof - 1, turned_back * chain.tip).after;
    tip_ = {Twice<Scalar>(cos(after)), Twice<Scalar>(sin(after))};
  }

  /// This arm with another Scalar.
  template <typename Other>
  [[nodiscard]] SerialArm<N, Other> cast() const {
    return SerialArm<N, Other>(*this);
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(pass_.dof()); }
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return limits_; }

  /// Characteristic length [m]: the sum of the distances from joint to joint and to the tip, plus the finite ranges of
  /// prismatic joints. If the sum is zero, the length is 1.
  [[nodiscard]] Scalar length() const noexcept { return length_; }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<3> and Pose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    pass_.slides() ? forward_pass<true, true>(q, qd, out) : forward_pass<true, false>(q, qd, out);
  }

  /// Tip and J at q. Jd does not change.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    pass_.slides() ? forward_pass<false, true>(q, q, out) : forward_pass<false, false>(q, q, out);
  }

  /// Tip at q. J and Jd do not change.
  template <typename Space>
  void points(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    pass_.slides() ? tip_only<true>(q, out) : tip_only<false>(q, out);
  }

 private:
  template <int, typename>
  friend class SerialArm;

  template <typename Other>
  explicit SerialArm(const SerialArm<N, Other>& arm)
      : pass_(arm.pass_),
        base_(arm.base_.template cast<Scalar>()),
        tip_(arm.tip_.template cast<Scalar>()),
        length_(static_cast<Scalar>(arm.length_)),
        limits_(arm.limits_.template cast<Scalar>()) {}

  /// Tip. Chains with and without prismatic joints have separate instantiations.
  template <bool kSlides, typename Space>
  [[gnu::flatten, gnu::noinline]] void tip_only(const Vector<N, Scalar>& q,
                                                Kinematics<Space, N, Scalar>& out) const noexcept {
    Screws<N, Scalar> axes;
    Frame<Scalar> frame = pass_.template operator()<false, kSlides>(base_, q, q, axes, AlongChain{});
    out.length = length_;
    if constexpr (std::is_same_v<Space, Pose>) {
      frame.turn(tip_.cosine.pair(), tip_.sine.pair());
      frame.store(out.tip.p, out.tip.R);
    } else {
      frame.p.store(out.tip.data());
    }
  }

  /// Tip, J and Jd. Chains with and without prismatic joints have separate instantiations.
  template <bool kWithRate, bool kSlides, typename Space>
  [[gnu::flatten, gnu::noinline]] void forward_pass(const Vector<N, Scalar>& q,
                                                    [[maybe_unused]] const Vector<N, Scalar>& qd,
                                                    Kinematics<Space, N, Scalar>& out) const noexcept {
    constexpr bool kWithOrientation = std::is_same_v<Space, Pose>;
    static_assert(kWithOrientation || std::is_same_v<Space, Position<3>>,
                  "a serial arm needs Position<3> or Pose as Space");
    using Axes = Screws<N, Scalar>;
    // g++ keeps axes and tip in memory if they are members of one object. A separate tip would occupy registers that
    // the columns need, and the kinematics would need 3 % more instructions (make count).
    struct Pass {
      Axes axes;
      typename Axes::Point tip{{}};
    } at;
    Frame<Scalar> frame = pass_.template operator()<kWithRate, kSlides>(base_, q, qd, at.axes, AlongChain{});
    const auto n = pass_.template joints<kSlides>();
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
      const auto columns = Axes::columns(i, at.axes.joints(i), at.tip, pass_.turns(), kSlides);
      columns.store(out.J, i);
      if constexpr (kWithRate) Axes::rates(i, at.axes.joints(i), columns, at.tip, qd).store(out.Jd, i);
    });
  }

  ForwardPass<N, Scalar> pass_;
  Transform<Scalar> base_;  ///< Frame of the first joint at position zero.
  FixedTurn<Scalar> tip_;   ///< Rotation about z from the frame at the end of the last link to the frame of the tip.
  Scalar length_{0};        ///< [m]
  JointLimits<N, Scalar> limits_;
};

}  // namespace fpbm
