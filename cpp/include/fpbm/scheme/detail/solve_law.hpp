#pragma once

#include <cmath>
#include <type_traits>
#include <utility>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/scheme/detail/factor_solver.hpp"
#include "fpbm/scheme/detail/self_motion_solver.hpp"
#include "fpbm/scheme/weights.hpp"
#include "fpbm/singular/detail/damped_gram.hpp"

/// The choice of the solver for the law of a scheme: scheme.law(solver, z), in terms of
///
///   solver.weighted()         J_W⁺b
///   solver.balanced(α)        (1−α) J⁺b + α J_W⁺b
///   solver.drift(α)           α W⁻¹Jdᵀμ,   μ = (JW⁻¹Jᵀ)⁻¹xd
///   solver.project(drift, z)  N_W (drift + z), or project(z) without a drift
///
/// With degree of redundancy 1, a SelfMotionSolver answers. Near singular postures, and with other degrees of
/// redundancy, a FactorSolver of JC (C Cᵀ = W⁻¹) answers if J⁺b is not necessary: at velocity level, if α = 1 or W = I.
/// Otherwise, and with lanes, a FactorSolver of J and JC answers.
namespace fpbm {

/// Whether the type of a scheme shows that J⁺b is not necessary. A law without J⁺b has a member type OnlyWeighted.
template <typename Scheme, typename = void>
inline constexpr bool kOnlyWeighted =
    Scheme::kLevel == Level::kVelocity || std::is_same_v<std::decay_t<decltype(Scheme::weights)>, UnitWeights>;
template <typename Scheme>
inline constexpr bool kOnlyWeighted<Scheme, std::void_t<typename Scheme::OnlyWeighted>> = true;

/// The law by a FactorSolver, of J and JC if Value is Pair<Scalar>. All rows of the task are in metres. undamped: the
/// result if damping does not act, or null. With lanes, the result is NaN in each lane in which damping may act.
/// Flattened, since a compiler may not inline small calls in a large translation unit.
template <typename Value, typename Scheme, int M, int N, typename Scalar>
[[nodiscard, gnu::flatten]] Status solve_by_factors(const Scheme& scheme, const TaskEquation<M, N, Scalar>& task,
                                                    const SecondaryMotion<Scheme::kLevel, N, Scalar>& z,
                                                    const Vector<N, Scalar>* undamped, Vector<N, Scalar>& u) noexcept {
  const auto& weights = scheme.weights;
  constexpr bool kPairs = !std::is_same_v<Value, Scalar>;
  const auto Jt = transpose_of(task.J);
  const Matrix<N, M, Value>& rows = [&]() noexcept -> decltype(auto) {
    if constexpr (kPairs) {
      return weights.with_unit(task.J);
    } else {
      return weights.root_transpose(Jt);
    }
  }();
  DampedGram<M, N, Value> gram(scheme.singular, task.J, rows);
  const Scalar bound = kPairs ? Scalar(1) : weights.template inverse_bound<Scalar>();
  const Status status = gram.factor(bound);
  if (undamped != nullptr && !gram.damps()) {
    u = *undamped;
    return Status::kOk;
  }
  if (failed(status)) return status;
  Vector<N, Scalar> result = gram.solved([&](const auto& solutions) noexcept -> Vector<N, Scalar> {
    const FactorSolver solver(solutions, weights, task);
    return solver.joint_motion(scheme.law(solver, z));
  });
  if (!is_finite(result)) return Status::kNotFinite;
  u = std::move(result);
  return status;
}

/// The law by the FactorSolver that the law needs. The last kTurns rows of the task are angular.
template <int kTurns, typename Scheme, int M, int N, typename Scalar>
[[nodiscard]] Status solve_by_factors(const Scheme& scheme, const TaskEquation<M, N, Scalar>& task,
                                      const Scalar& length, const SecondaryMotion<Scheme::kLevel, N, Scalar>& z,
                                      const Vector<N, Scalar>* undamped, Vector<N, Scalar>& u) noexcept {
  if constexpr (kTurns > 0) {
    const auto in_metres = [&](auto A) noexcept {
      for (Eigen::Index j = 0; j < A.cols(); ++j) {
        for (int i = M - kTurns; i < M; ++i) A.coeffRef(i, j) *= length;
      }
      return A;
    };
    const auto J = in_metres(task.J), Jd = in_metres(task.Jd);
    const auto b = in_metres(task.b), xd = in_metres(task.xd);
    return solve_by_factors<0>(scheme, TaskEquation<M, N, Scalar>{J, Jd, b, xd}, length, z, undamped, u);
  } else {
    if constexpr (kOnlyWeighted<Scheme>) {
      return solve_by_factors<Scalar>(scheme, task, z, undamped, u);
    } else {
      if constexpr (!kInLanes<Scalar>) {  // Each lane may have its own alpha.
        if (scheme.alpha == Scalar(1) || scheme.weights.is_unit()) {
          return solve_by_factors<Scalar>(scheme, task, z, undamped, u);
        }
      }
      return solve_by_factors<Pair<Scalar>>(scheme, task, z, undamped, u);
    }
  }
}

/// The law by a SelfMotionSolver, without damping. y: solution of J y = b, or pairs of solutions for b and xd, without
/// which the law has no drift.
template <typename Scheme, int M, int N, typename Scalar, typename Value>
[[gnu::always_inline]] inline void solve_by_self_motion(const Scheme& scheme, const SelfMotion<M, N, Scalar>& motion,
                                                        const TaskEquation<M, N, Scalar>& task,
                                                        const Vector<N, Value>& y,
                                                        const SecondaryMotion<Scheme::kLevel, N, Scalar>& z,
                                                        Vector<N, Scalar>& u) noexcept {
  const Vector<N, Scalar> v = motion.null();
  const Vector<N, Scalar>& Wv = scheme.weights.times(v);
  const SelfMotionSolver solver(motion, scheme.weights, task.Jd, y, v, Wv);
  solver.set(u, scheme.law(solver, z));
}

/// Sets u to the joint motion of the law: velocities or accelerations, by level. The last kTurns rows of the task are
/// angular. length: characteristic length of the arm [m]. Returns kDamped if damping acts. If the status is a failure,
/// u does not change.
///
/// The SelfMotionSolver answers without damping, before it is known whether damping acts. If damping does not act, this
/// answer is returned in all cases, so that a scheme with damping returns the same bits as a scheme without damping.
template <int kTurns, typename Scheme, int M, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Status solve_law(const Scheme& scheme, const TaskEquation<M, N, Scalar>& task,
                                                          const Scalar& length, const State<N, Scalar>& state,
                                                          Vector<N, Scalar>& u) noexcept {
  const SecondaryMotion<Scheme::kLevel, N, Scalar> z{scheme.null_space, state};
  if constexpr (!kHasSelfMotion<M, N>) {
    return solve_by_factors<kTurns, Scheme, M, N, Scalar>(scheme, task, length, z, nullptr, u);
  } else {
    const auto& damping = scheme.singular;
    const Mask<Scalar> undamped = damping.radius() == Scalar(0);
    Mask<Scalar> answered(false);
    Mask<Scalar> regular(false);  // Answered, and a bound on σ_min proves that damping does not act.
    Vector<N, Scalar> answer;
    SelfMotion<M, N, Scalar> motion;
    const auto solve = [&](Vector<N, Scalar>& result) noexcept {
      if constexpr (Scheme::kLevel == Level::kAcceleration) {
        if (!all_of(scheme.alpha == Scalar(0))) {
          const Vector<M, Pair<Scalar>> both = side_by_side<M, 1, Scalar>(task.b, task.xd);
          return solve_by_self_motion(scheme, motion, task, motion.solve(both), z, result);
        }
      }
      solve_by_self_motion(scheme, motion, task, motion.solve(task.b), z, result);
    };
    for (int kind = 0; kind < motion.kKinds && !all_of(answered); ++kind) {
      Mask<Scalar> found = motion.factor(task.J, kind);
      if (none_of(found)) continue;
      Mask<Scalar> bounded = undamped;
      if (!all_of(undamped)) {
        const Scalar threshold = damping.radius() * damping.radius() * squared_norm_in_metres<kTurns>(task.J, length);
        bounded = bounded || threshold * motion.rough_inverse_square(length) <= Scalar(1);
        if (!all_of(bounded)) bounded = bounded || threshold * motion.inverse_square(length) <= Scalar(1);
      }
      Vector<N, Scalar> lanes;
      Vector<N, Scalar>& result = kInLanes<Scalar> ? lanes : answer;
      solve(result);
      if (!is_finite(result)) break;
      if constexpr (kInLanes<Scalar>) {
        found = found && !answered;
        for (int i = 0; i < N; ++i) where(found, answer(i)) = result(i);
      }
      answered = answered || found;
      regular = regular || (found && bounded);
    }
    if (all_of(regular)) {
      u = std::move(answer);
      return Status::kOk;
    }
    const Vector<N, Scalar>* const known = !kInLanes<Scalar> && all_of(answered) ? &answer : nullptr;
    const Status status = solve_by_factors<kTurns>(scheme, task, length, z, known, u);
    if constexpr (kInLanes<Scalar>) {
      const Mask<Scalar> holds = regular || (answered && !isnan(u(0)));
      for (int i = 0; i < N; ++i) where(holds, u(i)) = answer(i);
    }
    return status;
  }
}

}  // namespace fpbm
