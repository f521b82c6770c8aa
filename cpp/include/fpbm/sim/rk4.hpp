#pragma once

#include "fpbm/core/status.hpp"

namespace fpbm {

/// The classic fourth-order Runge-Kutta method for dx/dt = f(t, x).
///
/// The derivative is `Status f(t, x, dx) noexcept`. A stage that fails ends the step and leaves x unchanged; otherwise
/// the step's status is the worst of its stages. X is any type with vector arithmetic, usually an Eigen matrix.
struct RK4 {
  /// One step of length h from (t, x), with k1 = f(t, x) already known.
  template <typename Derivative, typename Scalar, typename X>
  [[nodiscard]] static Status step(Derivative&& f, Scalar t, Scalar h, const X& k1, X& x) noexcept {
    const Scalar half = h / Scalar(2);
    X k2 = k1;
    X k3 = k1;
    X k4 = k1;
    X stage = x + half * k1;
    Status status = f(t + half, stage, k2);
    if (failed(status)) return status;
    stage = x + half * k2;
    status = worse(status, f(t + half, stage, k3));
    if (failed(status)) return status;
    stage = x + h * k3;
    status = worse(status, f(t + h, stage, k4));
    if (failed(status)) return status;
    x += h / Scalar(6) * (k1 + Scalar(2) * (k2 + k3) + k4);
    return status;
  }

  /// One step of length h from (t, x).
  template <typename Derivative, typename Scalar, typename X>
  [[nodiscard]] static Status step(Derivative&& f, Scalar t, Scalar h, X& x) noexcept {
    X k1 = x;
    const Status status = f(t, x, k1);
    if (failed(status)) return status;
    return worse(status, step(f, t, h, k1, x));
  }
};

}  // namespace fpbm
