#pragma once

#include <type_traits>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/core/status.hpp"
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

  /// X for a state.
  [[nodiscard]] static X packed(const State<N, Scalar>& state) noexcept {
    X x(state.q.size(), kSecondOrder ? 2 : 1);
    set_column(x, 0, state.q);
    if constexpr (kSecondOrder) set_column(x, 1, state.qd);
    return x;
  }

  /// dX/dt at X. Sets kinematics, state and qdd to the values at X. At velocity level, state.qd is the result of the
  /// scheme, and qdd is not used.
  [[nodiscard]] Status evaluate(const Reference<Space, Scalar>& reference, const X& x, X& dx) noexcept {
    update(x);
    return resolve(reference, dx);
  }

  /// Result of the scheme in the last resolve() [rad/s²], or [rad/s] at velocity level.
  [[nodiscard]] const Vector<N, Scalar>& motion() const noexcept { return kSecondOrder ? qdd : state.qd; }

  /// First part of evaluate(): state and kinematics at X.
  void update(const X& x) noexcept {
    state.q = column(x, 0);
    if constexpr (kSecondOrder) {
      state.qd = column(x, 1);
      arm.kinematics(state.q, state.qd, kinematics);
    } else {
      arm.kinematics(state.q, kinematics);
    }
  }

  /// Second part of evaluate(): dX/dt at the X of update(). sigma: null, or the address for a lower bound on σ_min(J)
  /// of the first level. If the scheme does not provide the bound on σ_min(J), *sigma does not change.
  [[nodiscard]] Status resolve(const Reference<Space, Scalar>& reference, X& dx, Scalar* sigma = nullptr) noexcept {
    Status status;
    if constexpr (kSecondOrder) {
      status = resolve(scheme, reference, qdd, sigma, 0);
      if (failed(status)) return status;
      set_column(dx, 0, state.qd);
      set_column(dx, 1, qdd);
    } else {
      Vector<N, Scalar> qd;  // Not state.qd, which the scheme may read.
      status = resolve(scheme, reference, qd, sigma, 0);
      if (failed(status)) return status;
      state.qd = qd;
      set_column(dx, 0, qd);
    }
    return status;
  }

 private:
  /// Result u of the scheme. A scheme may omit the argument sigma.
  template <typename Scheme_>
  [[nodiscard]] auto resolve(const Scheme_& s, const Reference<Space, Scalar>& reference, Vector<N, Scalar>& u,
                             Scalar* sigma, int) noexcept
      -> decltype(s.resolve(kinematics, reference, state, u, sigma)) {
    if constexpr (kLevelsOf<Space> == 1) {
      return s.resolve(kinematics, reference, state, u, sigma);
    } else {
      return s.resolve(kinematics, reference, state, u, sigma, &first);
    }
  }
  template <typename Scheme_>
  [[nodiscard]] Status resolve(const Scheme_& s, const Reference<Space, Scalar>& reference, Vector<N, Scalar>& u,
                               Scalar*, long) noexcept {
    return s.resolve(kinematics, reference, state, u);
  }
};

}  // namespace fpbm
