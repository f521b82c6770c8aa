#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/null_basis.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/singular/lost_directions.hpp"
#include "fpbm/task/feedback.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// The y of least norm that minimises ‖A y − r‖, damped where A is nearly singular:
///
///   y = Aᵀ(AAᵀ + Δ)⁻¹r
///
/// with the Δ of LostDirections. Smooth in A; |y| ≤ 1.17 |r|/ε. Zero where ε is lost in round-off.
template <int M, int K, typename Scalar>
[[nodiscard]] Vector<K, Scalar> damped_least_squares(const Matrix<M, K, Scalar>& A, const Vector<M, Scalar>& r,
                                                     Scalar epsilon_squared) noexcept {
  const Matrix<M, M, Scalar> gram = A.lazyProduct(A.transpose());
  Cholesky<M, Scalar> cholesky;
  if (cholesky.factor(gram + LostDirections<M, Scalar>(gram, epsilon_squared).delta) != Status::kOk) {
    return Vector<K, Scalar>::Zero(A.cols());
  }
  return A.transpose().lazyProduct(cholesky.solve(r));
}

/// A scheme with a second task in the null space of the first: the answer u of the scheme becomes u + Z y, where Z is
/// an orthonormal basis of the null space of J, and y brings J₂(u + Z y) as near as possible to the second task's
/// command (strict priority: Nakamura, Hanafusa and Yoshikawa 1987; Siciliano and Slotine 1991),
///
///   acceleration level: b₂ = xdd₂ − Jd₂qd + k₁(xd₂ − J₂qd) + k₂(x₂ ⊖ f₂(q))
///   velocity level:     v₂ = xd₂ + k₂(x₂ ⊖ f₂(q)).
///
/// The first task is not affected. The second is met where the arm has enough joints for both; where it has not, or
/// where the tasks conflict (an algorithmic singularity), y is damped and stays bounded.
///
/// The second task is the tip of another arm: one made of the first joints of the chain, whose tip is the elbow, say,
/// or a Gaze. SecondTask is a scheme itself. A SecondTask round another one is not a third task of lower priority: the
/// outer task acts in the null space of the first task alone, and disturbs the inner one. The wrapped scheme's
/// secondary motion z acts where neither task does. At acceleration level give that scheme NullSpace::with_damping:
/// nothing else brakes motion there (a Tracker gives its null_damping).
template <typename Scheme, typename Arm, typename Space>
struct SecondTask {
  using Scalar = typename Arm::Scalar;
  static constexpr Level kLevel = Scheme::kLevel;
  static constexpr int kDof = Scheme::kDof;

  Scheme scheme;
  Arm arm;                             ///< Its joints are the first joints of the first arm.
  Reference<Space, Scalar> reference;  ///< Of the second task. May change from call to call.
  Scalar k1;                           ///< Velocity feedback gain [1/s]; not used at velocity level.
  Scalar k2;                           ///< Position feedback gain [1/s²], or [1/s] at velocity level.
  Scalar radius;                       ///< ε as a share of ‖J₂‖_F, in (0, 1].

  SecondTask(const Scheme& scheme_, const Arm& arm_, const Reference<Space, Scalar>& reference_, Scalar k1_, Scalar k2_,
             Scalar radius_ = Scalar(0.05))
      : scheme(scheme_), arm(arm_), reference(reference_), k1(k1_), k2(k2_), radius(radius_) {
    validation::require_non_negative("second_task.k1", k1);
    validation::require_non_negative("second_task.k2", k2);
    validation::require_positive("second_task.radius", radius);
    validation::require_fraction("second_task.radius", radius);
  }

  /// Throws std::invalid_argument where a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    scheme.require_dof(dof);
    if (arm.dof() > dof) validation::fail("second_task.arm.dof", arm.dof(), "no more than the arm itself has");
  }

  /// Joint velocities [rad/s] or accelerations [rad/s²], the tip's the same as the scheme's own.
  template <typename First, int N>
  [[nodiscard]] Status resolve(const Kinematics<First, N, Scalar>& kinematics, const Reference<First, Scalar>& first,
                               const State<N, Scalar>& state, Vector<N, Scalar>& u) const noexcept {
    constexpr int M = Space::kRows;
    constexpr int kFree = kNullity<First::kRows, N>;
    const Eigen::Index head = arm.dof();
    State<Arm::kDof, Scalar> seen{state.q.head(head), {}};
    if constexpr (kLevel == Level::kAcceleration) seen.qd = state.qd.head(head);
    Vector<N, Scalar> result = Vector<N, Scalar>::Zero(state.q.size());
    const Status status = scheme.resolve(kinematics, first, state, result);
    if (failed(status)) return status;

    Kinematics<Space, Arm::kDof, Scalar> second;
    Vector<M, Scalar> r;
    if constexpr (kLevel == Level::kAcceleration) {
      arm.kinematics(seen.q, seen.qd, second);
      r = commanded_acceleration(k1, k2, second, reference, seen);
    } else {
      arm.kinematics(seen.q, second);
      r = commanded_velocity(k2, second, reference);
    }
    r -= second.J.lazyProduct(result.head(head));
    const auto Z = null_basis(kinematics.J);
    const Matrix<M, kFree, Scalar> A = second.J.lazyProduct(Z.topRows(head));
    result += Z.lazyProduct(damped_least_squares(A, r, radius * radius * second.J.squaredNorm()));
    if (!result.allFinite()) return Status::kNotFinite;
    u = result;
    return status;
  }
};

}  // namespace fpbm
