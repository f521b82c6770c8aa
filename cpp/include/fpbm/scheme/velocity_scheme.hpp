#pragma once

#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/scheme/detail/least_norm.hpp"
#include "fpbm/scheme/weights.hpp"
#include "fpbm/singular/damping.hpp"
#include "fpbm/task/detail/feedback.hpp"

namespace fpbm {

/// All velocity-level schemes of the paper, (3), (6) and (7), are this law (docs/equations.md):
///
///   qd = J_W⁺v + N_W z,   v = xd + k (x ⊖ f(q)).
///
/// MVN() and WMVN() in scheme/schemes.hpp return the schemes of the paper.
template <int N, typename Scalar = double, typename Weights = DiagonalWeights<N, Scalar>>
struct VelocityScheme {
  static constexpr Level kLevel = Level::kVelocity;
  static constexpr int kDof = N;

  Weights weights;
  Scalar k;                          ///< Position feedback gain [1/s].
  NullSpace<N, Scalar> null_space;   ///< Secondary velocity z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  /// Throws std::invalid_argument if k is negative or not finite.
  explicit VelocityScheme(const Weights& weights_, Scalar k_ = Scalar(0), const NullSpace<N, Scalar>& null_space_ = {},
                          const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : weights(weights_), k(k_), null_space(null_space_), singular(singular_) {
    validation::require_non_negative("k", k);
  }

  /// Throws std::invalid_argument if a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    weights.require_dof(dof);
    null_space.require_dof(dof);
  }

  /// Joint velocities qd [rad/s] that give the tip its reference velocity, corrected by the feedback. If the status is
  /// a failure, qd does not change.
  /// sigma, unless null, is set to the lower bound 1/√tr((JJᵀ)⁻¹) on σ_min(J), if the factorisation for qd provides
  /// this bound.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qd, Scalar* sigma = nullptr) const noexcept {
    const auto v = commanded_velocity(k, kinematics, reference);
    return solve<kScaledRows<Space, N>>(v, kinematics.J, kinematics.Jd, scale_of_rows(kinematics), state, qd, sigma);
  }

  /// Joint velocities with J qd = b for any rows, all in metres: the law without feedback.
  template <int M>
  [[nodiscard]] Status resolve_rows(const Vector<M, Scalar>& b, const Vector<M, Scalar>&, const Matrix<M, N, Scalar>& J,
                                    const Matrix<M, N, Scalar>& Jd, const State<N, Scalar>& state,
                                    Vector<N, Scalar>& qd, Scalar* sigma = nullptr) const noexcept {
    return solve<kScaledRows<Position<M>, N>>(b, J, Jd, Scalar(1), state, qd, sigma);
  }

 private:
  template <int kTurns, int M>
  [[nodiscard]] Status solve(const Vector<M, Scalar>& v, const Matrix<M, N, Scalar>& J, const Matrix<M, N, Scalar>& Jd,
                             const Scalar& length, const State<N, Scalar>& state, Vector<N, Scalar>& qd,
                             Scalar* sigma) const noexcept {
    if constexpr (kHasSelfMotion<M, N>) {
      auto undamped = undamped_result<kTurns>(
          singular, J, length,
          [&](const auto& motion, Vector<N, Scalar>& u) noexcept {
            with_one_self_motion<kLevel>(motion, weights, Scalar(1), v, Jd, null_space, state, u);
          },
          sigma);
      if (all_of(undamped.regular)) {
        qd = std::move(undamped.u);
        return Status::kOk;
      }
      return solve_by_factorisation<kTurns>(v, J, length, state, undamped, qd, sigma);
    } else {
      return solve_by_factorisation<kTurns>(v, J, length, state, NoUndampedResult{}, qd, sigma);
    }
  }

  template <int kTurns, int M, typename Known>
  [[nodiscard]] Status solve_by_factorisation(const Vector<M, Scalar>& v, const Matrix<M, N, Scalar>& J,
                                              const Scalar& length, const State<N, Scalar>& state,
                                              const Known& undamped, Vector<N, Scalar>& qd,
                                              Scalar* sigma) const noexcept {
    return least_norm<kLevel, kTurns>(weights, v, NoForce{}, null_space, singular, J, length, state, undamped, qd,
                                      sigma);
  }
};

}  // namespace fpbm
