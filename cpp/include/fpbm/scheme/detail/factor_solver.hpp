#pragma once

#include <type_traits>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/scheme/detail/task_equation.hpp"

namespace fpbm {

/// Solver of a law (solve_law.hpp) by factorisation of the rows of JC, C Cᵀ = W⁻¹, or, with Value = Pair<Scalar>, of
/// the rows of J and of JC in parallel (docs/equations.md, Other degrees of redundancy):
///
///   J_W⁺b = C (JC)⁺b,   N_W u = C P C⁻¹u,   P = I − (JC)⁺JC.
///
/// A joint motion u is represented by y = C⁻¹u. solutions: DampedGram::Solutions.
template <typename Solutions, typename Weights, int M, int N, typename Scalar>
class FactorSolver {
  using Value = typename Solutions::Entry;

 public:
  FactorSolver(const Solutions& solutions, const Weights& weights, const TaskEquation<M, N, Scalar>& task) noexcept
      : solutions_(solutions), weights_(weights), task_(task) {}

  struct Motion {
    Vector<N, Scalar> y;
    Vector<N, Value> parts;  ///< Pairs: C y and the first entries are the motion.

    friend Motion operator+(Motion a, const Vector<N, Scalar>& null) noexcept {
      a.y = sum_of(null, a.y);
      return a;
    }
  };

  /// J_W⁺b. With pairs: see balanced().
  [[nodiscard]] Motion weighted() const noexcept {
    const Vector<N, Scalar> y = solutions_.motion(task_.b);
    return {y, y};
  }
  /// (1−α) J⁺b + α J_W⁺b. With one factorisation, α = 1 or W = I, so that this is J_W⁺b.
  [[nodiscard]] Motion balanced([[maybe_unused]] const Scalar& alpha) const noexcept {
    if constexpr (!kPairs) {
      return weighted();
    } else {
      const Vector<M, Value> shares = entrywise_as<Value>(
          task_.b, [&](Eigen::Index i) { return Value(Scalar(1) - alpha, alpha) * Value(task_.b.coeff(i)); });
      const Vector<N, Value> parts = solutions_.motion(shares);
      return {last(parts), parts};
    }
  }

  /// α W⁻¹Jdᵀμ, μ = (JW⁻¹Jᵀ)⁻¹xd, which project() evaluates unless α = 0.
  struct Drift {
    Scalar alpha;
  };
  [[nodiscard]] Drift drift(const Scalar& alpha) const noexcept { return {alpha}; }

  /// N_W (drift + z). Near singular postures, the part of z that depends on the posture is projected without damping,
  /// and z has the brake in addition (docs/singularities.md, Secondary motion).
  template <typename Z>
  [[nodiscard]] Vector<N, Scalar> project(const Drift& drift, const Z& z) const noexcept {
    constexpr bool kDamped = Solutions::kIsDamped;
    constexpr bool kBraked = kDamped && Z::kLevel == Level::kAcceleration;
    const bool drifts = !all_of(drift.alpha == Scalar(0));
    auto y = filled<Vector<N, Scalar>>(z.state.q.size());
    if (!(drifts || kBraked || z.active())) return y;
    if (drifts) {
      const Vector<M, Scalar> mu = last(solutions_.force(repeated(task_.xd)));
      const Vector<N, Scalar> force = transpose_times(task_.Jd, mu);  // C⁻¹W⁻¹Jdᵀμ = CᵀJdᵀμ.
      y = weights_.root_transpose(entrywise(force, [&](Eigen::Index i) { return drift.alpha * force.coeff(i); }));
    }
    if (kDamped || z.active()) {
      const Vector<N, Scalar> u =
          kDamped ? z.null_space.template velocity_part<Z::kLevel>(z.state, solutions_.of.brake()) : z.value();
      y = sum_of(y, weights_.inverse_root(u));
    }
    y = last(solutions_.project(repeated(y)));
    if constexpr (kDamped) {
      if (z.null_space.template active<Level::kVelocity>()) {
        const Vector<N, Scalar> u = weights_.inverse_root(z.null_space.template at<Level::kVelocity>(z.state));
        y = sum_of(y, last(solutions_.secondary(repeated(u), task_.b)));
      }
    }
    return y;
  }
  template <typename Z>
  [[nodiscard]] Vector<N, Scalar> project(const Z& z) const noexcept {
    return project(Drift{Scalar(0)}, z);
  }

  /// The joint motion.
  [[nodiscard]] Vector<N, Scalar> joint_motion(const Motion& motion) const noexcept {
    if constexpr (kPairs) {
      return plus_first<N, Scalar>(weights_.root(motion.y), motion.parts);
    } else {
      return weights_.root(motion.y);
    }
  }

 private:
  static constexpr bool kPairs = !std::is_same_v<Value, Scalar>;

  template <int Size>
  [[nodiscard]] static auto repeated(const Vector<Size, Scalar>& a) noexcept {
    if constexpr (kPairs) {
      return side_by_side<Size, 1, Scalar>(a, a);
    } else {
      return a;
    }
  }
  template <int Size>
  [[nodiscard]] static Vector<Size, Scalar> last(const Vector<Size, Value>& a) noexcept {
    if constexpr (kPairs) {
      return second<Size, 1, Scalar>(a);
    } else {
      return a;
    }
  }

  const Solutions& solutions_;
  const Weights& weights_;
  const TaskEquation<M, N, Scalar>& task_;
};

}  // namespace fpbm
