#pragma once

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/model/detail/spread_posture.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/singular/damping.hpp"

namespace fpbm {

/// The law J_W⁺b + N_W (drift + z), for weights and a secondary motion of one state:
///
///   kDrifts: drift = W⁻¹Jdᵀμ, μ = (JW⁻¹Jᵀ)⁻¹xd, so that the law is WMVN (9). Otherwise, drift = 0.
///
/// The members are those that solve_law() needs.
template <Level kLevel_, bool kDrifts, int N, typename Scalar, typename Weights>
struct WeightedLaw {
  using OnlyWeighted = void;
  static constexpr Level kLevel = kLevel_;
  static constexpr Scalar alpha = Scalar(1);  // NOLINT(readability-identifier-naming): as in AccelerationScheme.

  const Weights& weights;
  const NullSpace<N, Scalar>& null_space;
  const SingularDamping<Scalar>& singular;

  template <typename Solver, typename Z>
  [[nodiscard, gnu::always_inline]] auto law(const Solver& solver, const Z& z) const noexcept {
    if constexpr (kDrifts) {
      return solver.weighted() + solver.project(solver.drift(alpha), z);
    } else {
      return solver.weighted() + solver.project(z);
    }
  }
};

/// Throws std::invalid_argument if a drive moves no mass, so that the mass matrix of the model is singular.
template <typename Model>
void require_mass_matrix(const Model& model) {
  typename Model::State state;
  model.robot().update(spread_posture(model.robot().limits(), 0), state);
  Cholesky<Model::kDof, typename Model::Scalar> cholesky;
  if (cholesky.factor(model.mass_matrix(state)) == Status::kOk) return;
  validation::reject(
      validation::element("joints", cholesky.lost_pivot()),
      " moves no mass: must move a link with a mass, or have a rotor inertia: give the inertia of links");
}

}  // namespace fpbm
