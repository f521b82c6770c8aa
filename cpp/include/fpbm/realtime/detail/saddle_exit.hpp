#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/linalg/detail/eigenpairs_below.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/realtime/detail/task_distance.hpp"
#include "fpbm/task/detail/stack_kinematics.hpp"

namespace fpbm {

/// Rows of the first task level and their errors e, in metres up to the weights: the energy of the error is
/// E = ½ Σ weights(k) e_k².
template <int M, int N, typename Scalar>
struct FirstLevel {
  const Matrix<M, N, Scalar>& J;
  const Matrix<M, N, Scalar>& Jd;
  Vector<M, Scalar> error;
  Vector<M, Scalar> weights;
};

template <typename Space, int N, typename Scalar>
[[nodiscard]] FirstLevel<Space::kRows, N, Scalar> first_level(
    const Kinematics<Space, N, Scalar>& kinematics, const typename Space::template Point<Scalar>& x) noexcept {
  auto weights = filled<Vector<Space::kRows, Scalar>>(Space::kRows, Scalar(1));
  for (int i = Space::kRows - Space::kTurns; i < Space::kRows; ++i) {
    weights(i) = kinematics.length * kinematics.length;
  }
  return {kinematics.J, kinematics.Jd, task_error(kinematics, x), weights};
}
template <typename... Levels, int N, typename Scalar>
[[nodiscard]] auto first_level(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics,
                               const typename StackSpace<Levels...>::template Point<Scalar>& x) noexcept {
  using Space = StackSpace<Levels...>;
  const auto& level = std::get<0>(kinematics.levels);
  constexpr int M = Stack<Levels...>::kRows[0];
  auto error = filled<Vector<M, Scalar>>(level.rows());
  Eigen::Index to = 0;
  Space::each([&](auto space, auto i, int) noexcept {
    constexpr std::size_t kTask = decltype(i)::value;
    if constexpr (kTask < static_cast<std::size_t>(Space::kFirst)) {
      using Part = decltype(space);
      const Vector<Part::kRows, Scalar> whole =
          Part::template difference<Scalar>(std::get<kTask>(x), std::get<kTask>(kinematics.tip));
      const auto& S = std::get<kTask>(kinematics.tasks).S;
      for (Eigen::Index row = 0; row < S.rows(); ++row, ++to) {
        for (Eigen::Index j = 0; j < S.cols(); ++j) error(to) += S.coeff(row, j) * whole(j);
      }
    }
  });
  return FirstLevel<M, N, Scalar>{level.J, level.Jd, error, filled<Vector<M, Scalar>>(level.rows(), Scalar(1))};
}

/// Posture near a saddle point of the task error (docs/recovery.md, Singular postures at rest).
template <int N, typename Scalar>
struct SaddleExit {
  Vector<N, Scalar> q;
  Scalar distance;  ///< Distance of its tip from the target, as TaskDistance.
};

/// Hessian of the energy E of the error of the first level, with respect to the joints:
///
///   JᵀJ − Σ e_k ∂²f_k/∂q².
///
/// J̇ is linear in q̇, and column j of Σ e_k ∂²f_k/∂q² is J̇ᵀe for the velocity 1 of joint j alone. The derivatives of
/// angular rows are not symmetric; their symmetric part is used.
template <typename Space, int N, typename Scalar, typename Arm>
[[nodiscard]] Matrix<N, N, Scalar> error_hessian(const Arm& arm, const Vector<N, Scalar>& q,
                                                 const typename Space::template Point<Scalar>& x) noexcept {
  const Eigen::Index n = q.size();
  auto hessian = filled<Matrix<N, N, Scalar>>(n);
  Kinematics<Space, N, Scalar> kinematics;
  for (Eigen::Index j = 0; j < n; ++j) {
    auto unit = filled<Vector<N, Scalar>>(n);
    unit(j) = Scalar(1);
    arm.kinematics(q, unit, kinematics);
    const auto level = first_level(kinematics, x);
    for (Eigen::Index i = 0; i < n; ++i) {
      Scalar sum(0);
      for (Eigen::Index k = 0; k < level.error.size(); ++k) {
        sum += level.weights(k) * (level.J(k, i) * level.J(k, j) - level.Jd(k, i) * level.error(k));
      }
      hessian(std::max(i, j), std::min(i, j)) += sum / (i == j ? Scalar(1) : Scalar(2));
    }
  }
  return hessian;
}

/// Posture from which the feedback of the tip can continue, for an arm at rest in a singular posture with Jᵀe = 0. The
/// posture is a stationary point of the error. Along the eigenvectors of the Hessian of E with negative eigenvalues,
/// the error decreases to second order. Without a negative eigenvalue, for example in an outstretched arm with an
/// unreachable target, the posture is a local minimum of the error.
///
/// The result is the posture with the smallest error among postures q ± s v within the ranges of the joints, with these
/// unit eigenvectors v and several distances s, or q. If the errors of both signs are equal, the sign leads toward the
/// middle of the ranges. x: target. near: target of the feedback (Correction).
template <typename Space, int N, typename Scalar, typename Arm>
[[nodiscard, gnu::cold, gnu::noinline]] SaddleExit<N, Scalar> saddle_exit(
    const Arm& arm, const Vector<N, Scalar>& q, const typename Space::template Point<Scalar>& x,
    const typename Space::template Point<Scalar>& near, const JointLimits<N, Scalar>& bounds) noexcept {
  /// Largest distance s [rad], and number of distances, each half of the previous. Not tuned. A posture that the ranges
  /// of the joints move back by more than half of s is not evaluated.
  constexpr Scalar kFarthest = Scalar(0.8);
  constexpr int kDistances = 4;
  /// A difference of less than 1 % of two errors is a tie.
  constexpr Scalar kTie = Scalar(0.01);

  Kinematics<Space, N, Scalar> kinematics;
  const auto distance = [&](const Vector<N, Scalar>& posture) noexcept {
    arm.kinematics(posture, kinematics);
    return TaskDistance<Space, Scalar>::norm(task_error(kinematics, x), kinematics.length);
  };
  const EigenpairsBelow<N, Scalar> pairs(error_hessian<Space>(arm, q, near), Scalar(0));
  SaddleExit<N, Scalar> best{q, distance(q)};
  const Scalar start = best.distance;
  for (Eigen::Index k = 0; k < pairs.count(); ++k) {
    if (!(pairs.value(k) < Scalar(0))) continue;
    const Vector<N, Scalar> v = pairs.vector(k);
    Scalar inward(0);
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Scalar middle = (bounds.lower(i) + bounds.upper(i)) / Scalar(2);
      if (std::isfinite(middle)) inward += v(i) * (middle - q(i));
    }
    Scalar s = inward < Scalar(0) ? -kFarthest : kFarthest;
    for (int trial = 0; trial < 2 * kDistances; ++trial) {
      const Vector<N, Scalar> posture =
          entrywise(q, [&](Eigen::Index i) { return std::clamp(q(i) + s * v(i), bounds.lower(i), bounds.upper(i)); });
      const Scalar moved = norm(entrywise(q, [&](Eigen::Index i) { return posture(i) - q(i); }));
      const Scalar found = moved < std::abs(s) / Scalar(2) ? start : distance(posture);
      if (found < best.distance - kTie * (start - found)) best = {posture, found};
      s *= trial % 2 == 0 ? Scalar(-1) : Scalar(-0.5);
    }
  }
  return best;
}

}  // namespace fpbm
