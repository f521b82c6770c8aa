#pragma once

#include <cmath>

#include "fpbm/geometry/space.hpp"
#include "fpbm/model/joint.hpp"

/// Continuous joints rotate without bounds. Positions of a continuous joint that differ by 2π are equal: differences of
/// its positions are modulo 2π.
namespace fpbm {

/// Whether a joint with a drive is continuous: it rotates, and has no bound on position.
template <typename Scalar>
[[nodiscard]] bool is_continuous(JointType type, const JointBounds<Scalar>& bounds) noexcept {
  return type != JointType::kPrismatic && !(bounds.lower > -JointBounds<Scalar>::kNone) &&
         !(bounds.upper < JointBounds<Scalar>::kNone);
}

/// Bits of the continuous joints of an arm; 0 if the arm has no limits().
template <typename Arm>
[[nodiscard]] auto continuous_joints(const Arm& arm, int) -> decltype(arm.limits().continuous) {
  return arm.limits().continuous;
}
template <typename Arm>
[[nodiscard]] JointBits continuous_joints(const Arm&, long) {
  return 0;
}

/// Bits of the continuous joints of an arm that have no bound on position in the given limits.
template <typename Arm, int N, typename Scalar>
[[nodiscard]] JointBits continuous_joints(const Arm& arm, const JointLimits<N, Scalar>& limits) {
  JointBits joints = continuous_joints(arm, 0);
  for (Eigen::Index i = 0; i < limits.lower.size(); ++i) {
    if (!is_continuous(JointType::kContinuous, limits.joint(i))) joints &= ~joint_bit(i);
  }
  return joints;
}

/// An angle rounded to the nearest multiple of 2π.
template <typename Scalar>
[[nodiscard]] Scalar whole_turns(const Scalar& angle) noexcept {
  using std::round;
  return Scalar(kTwoPi) * round(angle * Scalar(1.0 / kTwoPi));
}

/// Moves the positions of continuous joints by whole turns, to the posture that is nearest to another posture.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> nearest_turns(Vector<N, Scalar> q, const Vector<N, Scalar>& to,
                                              JointBits joints) noexcept {
  for (Eigen::Index i = 0; joints != 0 && i < q.size(); ++i) {
    if ((joints >> i & 1U) != 0) q.coeffRef(i) += whole_turns(to.coeff(i) - q.coeff(i));
  }
  return q;
}

}  // namespace fpbm
