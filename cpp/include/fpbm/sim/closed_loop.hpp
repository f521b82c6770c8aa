#pragma once

#include "fpbm/core/level.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// An arm under a scheme, as an ordinary differential equation in X = q (velocity level) or X = [q, qd].
template <typename Arm, typename Scheme, typename Space>
struct ClosedLoop {
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  static constexpr bool kSecondOrder = Scheme::kLevel == Level::kAcceleration;
  using X = Matrix<N, kSecondOrder ? 2 : 1, Scalar>;

  const Arm& arm;
  const Scheme& scheme;
  Kinematics<Space, N, Scalar> kinematics;
  State<N, Scalar> state;
  Vector<N, Scalar> qdd;

  /// dX/dt at X; keeps the kinematics, the state and the accelerations of this evaluation.
  [[nodiscard]] Status evaluate(const Reference<Space, Scalar>& reference, const X& x, X& dx) noexcept {
    update(x);
    return resolve(reference, dx);
  }

  /// The first half: state and kinematics at X.
  void update(const X& x) noexcept {
    state.q = x.col(0);
    if constexpr (kSecondOrder) {
      state.qd = x.col(1);
      arm.kinematics(state.q, state.qd, kinematics);
    } else {
      arm.kinematics(state.q, kinematics);
    }
  }

  /// The second: dX/dt there.
  [[nodiscard]] Status resolve(const Reference<Space, Scalar>& reference, X& dx) noexcept {
    Status status;
    if constexpr (kSecondOrder) {
      status = scheme.resolve(kinematics, reference, state, qdd);
      if (failed(status)) return status;
      dx.col(0) = state.qd;
      dx.col(1) = qdd;
    } else {
      status = scheme.resolve(kinematics, reference, state, state.qd);
      if (failed(status)) return status;
      dx.col(0) = state.qd;
    }
    return status;
  }
};

}  // namespace fpbm
