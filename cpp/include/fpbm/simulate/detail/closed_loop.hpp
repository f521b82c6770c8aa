#pragma once

#include <type_traits>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/scheme/detail/require_members.hpp"

namespace fpbm {

/// Arm with a scheme as an ordinary differential equation in X: X is q at velocity level, and [q, qd] at acceleration
/// level.
template <typename Arm, typename Scheme, typename Space>
struct ClosedLoop {
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  static_assert(require_members<Scheme, Space, N, Scalar>());
  static constexpr bool kSecondOrder = Scheme::kLevel == Level::kAcceleration;
  struct NoMotion {};
  using X = Matrix<N, kSecondOrder ? 2 : 1, Scalar>;

  const Arm& arm;
  const Scheme& scheme;
  Kinematics<Space, N, Scalar> kinematics;
  State<N, Scalar> state;
  Vector<N, Scalar> qdd;
  /// Motion of the first level alone, if the tasks have several levels [rad/s²], or [rad/s] at velocity level.
  std::conditional_t<kLevelsOf<Space> == 1, NoMotion, Vector<N, Scalar>> first{};

  /// dX/dt at X. Sets kinematics, state and motion to the values at X.
  [[nodiscard]] Status evaluate(const Reference<Space, Scalar>& reference, const X& x, X& dx) noexcept {
    state.q = column(x, 0);
    if constexpr (kSecondOrder) {
      state.qd = column(x, 1);
      arm.kinematics(state.q, state.qd, kinematics);
    } else {
      arm.kinematics(state.q, kinematics);
    }
    const Status status = resolve(reference);
    if (failed(status)) return status;
    if constexpr (kSecondOrder) {
      set_column(dx, 0, state.qd);
      set_column(dx, 1, qdd);
    } else {
      set_column(dx, 0, state.qd);
    }
    return status;
  }

  /// Computes motion() from the state and its kinematics. If the status is a failure, motion() does not change.
  [[nodiscard]] Status resolve(const Reference<Space, Scalar>& reference) noexcept {
    auto u = motion();  // Not state.qd, which the scheme may read.
    const Status status = resolve(reference, u);
    (kSecondOrder ? qdd : state.qd) = u;
    return status;
  }

  /// Result of the scheme in the last resolve() [rad/s²], or [rad/s] at velocity level.
  [[nodiscard]] const Vector<N, Scalar>& motion() const noexcept { return kSecondOrder ? qdd : state.qd; }

 private:
  /// Result u of the scheme.
  [[nodiscard]] Status resolve(const Reference<Space, Scalar>& reference, Vector<N, Scalar>& u) noexcept {
    if constexpr (kLevelsOf<Space> == 1) {
      return scheme.resolve(kinematics, reference, state, u);
    } else {
      return scheme.resolve(kinematics, reference, state, u, &first);
    }
  }
};

}  // namespace fpbm
