#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// Classic fourth-order Runge-Kutta method for dx/dt = f(t, x).
///
/// The derivative is `Status f(t, x, dx) noexcept`. If a stage fails, the step ends and x does not change. Otherwise,
/// the status of the step is the most severe status of its stages. X is any type with vector arithmetic, usually an
/// Eigen matrix.
struct RK4 {
  /// One step of length h from (t, x), if k1 = f(t, x) is already known.
  template <typename Derivative, typename Scalar, typename X>
  [[nodiscard]] static Status step(Derivative&& f, Scalar t, Scalar h, const X& k1, X& x) noexcept {
    const Scalar half = h / Scalar(2);
    X k2 = of_size(k1);
    X k3 = of_size(k1);
    X k4 = of_size(k1);
    X stage = plus(x, half, k1);
    Status status = f(t + half, stage, k2);
    if (failed(status)) return status;
    stage = plus(x, half, k2);
    status = worse(status, f(t + half, stage, k3));
    if (failed(status)) return status;
    stage = plus(x, h, k3);
    status = worse(status, f(t + h, stage, k4));
    if (failed(status)) return status;
    x = plus(x, h / Scalar(6), sum(k1, k2, k3, k4));
    return status;
  }

  /// One step of length h from (t, x).
  template <typename Derivative, typename Scalar, typename X>
  [[nodiscard]] static Status step(Derivative&& f, Scalar t, Scalar h, X& x) noexcept {
    X k1 = of_size(x);
    const Status status = f(t, x, k1);
    if (failed(status)) return status;
    return worse(status, step(f, t, h, k1, x));
  }

 private:
  /// A value with the size of x. The entries of a Matrix are not set; any other type is copied.
  template <typename X>
  [[nodiscard]] static X of_size(const X& x) noexcept {
    return x;
  }
  template <int Rows, int Cols, typename Scalar>
  [[nodiscard]] static Matrix<Rows, Cols, Scalar> of_size(const Matrix<Rows, Cols, Scalar>& x) noexcept {
    Matrix<Rows, Cols, Scalar> result;
    result.resize(x.rows(), x.cols());
    return result;
  }

  /// x + h k.
  template <typename Scalar, typename X>
  [[nodiscard]] static X plus(const X& x, const Scalar& h, const X& k) noexcept {
    return x + h * k;
  }
  template <typename Time, int Rows, int Cols, typename Scalar>
  [[nodiscard]] static Matrix<Rows, Cols, Scalar> plus(const Matrix<Rows, Cols, Scalar>& x, const Time& h,
                                                       const Matrix<Rows, Cols, Scalar>& k) noexcept {
    return entrywise(x, [&](Eigen::Index i) { return x.coeff(i) + h * k.coeff(i); });
  }

  /// k₁ + 2 (k₂ + k₃) + k₄.
  template <typename X>
  [[nodiscard]] static X sum(const X& k1, const X& k2, const X& k3, const X& k4) noexcept {
    return k1 + 2 * (k2 + k3) + k4;
  }
  template <int Rows, int Cols, typename Scalar>
  [[nodiscard]] static Matrix<Rows, Cols, Scalar> sum(const Matrix<Rows, Cols, Scalar>& k1,
                                                      const Matrix<Rows, Cols, Scalar>& k2,
                                                      const Matrix<Rows, Cols, Scalar>& k3,
                                                      const Matrix<Rows, Cols, Scalar>& k4) noexcept {
    return entrywise(
        k1, [&](Eigen::Index i) { return k1.coeff(i) + Scalar(2) * (k2.coeff(i) + k3.coeff(i)) + k4.coeff(i); });
  }
};

}  // namespace fpbm
