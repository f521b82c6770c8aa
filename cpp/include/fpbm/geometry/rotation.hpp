#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/detail/sincos.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// A B for A of three rows, with the same round-off error as Eigen's lazyProduct(): rows that fill a pair of doubles
/// are summed as (x + y) + z, other rows as x + (y + z).
template <int Cols, typename Scalar>
[[nodiscard]] Matrix<3, Cols, Scalar> times(const Matrix<3, 3, Scalar>& A, const Matrix<3, Cols, Scalar>& B) noexcept {
  constexpr bool kInPairs = std::is_same_v<Scalar, double>;
  Matrix<3, Cols, Scalar> result;
  for (int j = 0; j < Cols; ++j) {
    for (int i = 0; i < 3; ++i) {
      const Scalar x = A.coeff(i, 0) * B.coeff(0, j);
      const Scalar y = A.coeff(i, 1) * B.coeff(1, j);
      const Scalar z = A.coeff(i, 2) * B.coeff(2, j);
      result.coeffRef(i, j) = kInPairs && i < 2 ? (x + y) + z : x + (y + z);
    }
  }
  return result;
}

/// Pose of a frame b in a frame a: x_a = p + R x_b.
template <typename Scalar = double>
struct Transform {
  Vector<3, Scalar> p = filled<Vector<3, Scalar>>(3);         ///< Origin of b in a [m].
  Matrix<3, 3, Scalar> R = identity<Matrix<3, 3, Scalar>>();  ///< Columns: the axes of b in a.

  template <typename Other>
  [[nodiscard]] Transform<Other> cast() const noexcept {
    return {p.template cast<Other>(), R.template cast<Other>()};
  }

  /// Composition: T_ac = T_ab T_bc.
  [[nodiscard]] friend Transform operator*(const Transform& a, const Transform& b) noexcept {
    const Vector<3, Scalar> turned = times(a.R, b.p);
    return {entrywise(turned, [&](Eigen::Index i) { return a.p.coeff(i) + turned.coeff(i); }), times(a.R, b.R)};
  }
};

/// a/|a|, or a if |a| = 0.
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> normalized(const Vector<3, Scalar>& a) noexcept {
  using std::sqrt;
  const Scalar square = squared_norm(a);
  if (!(square > Scalar(0))) return a;
  const Scalar length = sqrt(square);
  return entrywise(a, [&](Eigen::Index i) { return a.coeff(i) / length; });
}

template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> cross(const Vector<3, Scalar>& a, const Vector<3, Scalar>& b) noexcept {
  return {a(1) * b(2) - a(2) * b(1), a(2) * b(0) - a(0) * b(2), a(0) * b(1) - a(1) * b(0)};
}

template <typename Scalar>
[[nodiscard]] Matrix<3, 3, Scalar> transposed(const Matrix<3, 3, Scalar>& R) noexcept {
  return entrywise(R, [&](Eigen::Index i) { return R.coeff(i / 3, i % 3); });
}

/// Inverse of a pose of b in a: the pose of a in b.
template <typename Scalar>
[[nodiscard]] Transform<Scalar> inverse(const Transform<Scalar>& a) noexcept {
  const Matrix<3, 3, Scalar> back = transposed(a.R);
  const Vector<3, Scalar> p = times(back, a.p);
  return {entrywise(p, [&](Eigen::Index i) { return -p.coeff(i); }), back};
}

template <typename Scalar>
[[nodiscard]] Scalar trace_of(const Matrix<3, 3, Scalar>& R) noexcept {
  return R.coeff(0, 0) + (R.coeff(1, 1) + R.coeff(2, 2));
}

/// Unit quaternion (w, v) of a rotation vector r [rad], w = cos(|r|/2).
template <typename Scalar>
[[nodiscard]] Vector<4, Scalar> quaternion(const Vector<3, Scalar>& r) noexcept {
  // With the half angle a, cos(a) and sin(a)/a are accurate near |r| = 0, where sin(a)/a is 1 up to round-off.
  const Scalar half = norm(r) / Scalar(2);
  const SinCos<Scalar> angle = sincos(half);
  const Scalar sinc = half > Scalar(0) ? angle.sin / half : Scalar(1);
  const Scalar scale = sinc / Scalar(2);
  return {angle.cos, scale * r.coeff(0), scale * r.coeff(1), scale * r.coeff(2)};
}

/// Unit quaternion (w, v) of a rotation matrix, w ≥ 0.
///
/// The largest entry is computed first, from the diagonal (S. W. Shepperd, Quaternion from rotation matrix, 1978). The
/// result is accurate at every angle, including 0 and π.
template <typename Scalar>
[[nodiscard]] Vector<4, Scalar> quaternion(const Matrix<3, 3, Scalar>& R) noexcept {
  using std::sqrt;
  const Scalar trace = trace_of(R);
  Vector<4, Scalar> q;
  Eigen::Index i = 0;
  for (Eigen::Index other = 1; other < 3; ++other) {
    if (R(other, other) > R(i, i)) i = other;
  }
  if (trace >= R(i, i)) {
    const Scalar root = sqrt(Scalar(1) + trace);
    const Scalar twice = Scalar(2) * root;
    return {root / Scalar(2), (R(2, 1) - R(1, 2)) / twice, (R(0, 2) - R(2, 0)) / twice, (R(1, 0) - R(0, 1)) / twice};
  }
  const Eigen::Index j = (i + 1) % 3;
  const Eigen::Index k = (i + 2) % 3;
  const Scalar root = sqrt(Scalar(1) + R(i, i) - R(j, j) - R(k, k));
  q(1 + i) = root / Scalar(2);
  q(1 + j) = (R(i, j) + R(j, i)) / (Scalar(2) * root);
  q(1 + k) = (R(i, k) + R(k, i)) / (Scalar(2) * root);
  q(0) = (R(k, j) - R(j, k)) / (Scalar(2) * root);
  if (q(0) < Scalar(0)) {
    for (int e = 0; e < 4; ++e) q(e) = -q(e);
  }
  return q;
}

/// Vector part of a b*, where b* is the conjugate of b. The vector part of q̇ q* is half the angular velocity.
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> vector_of_quotient(const Vector<4, Scalar>& a, const Vector<4, Scalar>& b) noexcept {
  const Vector<3, Scalar> v(a(1), a(2), a(3));
  const Vector<3, Scalar> w(b(1), b(2), b(3));
  const Vector<3, Scalar> across = cross(v, w);
  return entrywise(v, [&](Eigen::Index i) { return b(0) * v(i) - a(0) * w(i) - across(i); });
}

/// Rotation matrix of a unit quaternion (w, v): (w² − |v|²) I + 2 v vᵀ + 2 w [v]×.
template <typename Scalar>
[[nodiscard]] Matrix<3, 3, Scalar> rotation(const Vector<4, Scalar>& q) noexcept {
  const Scalar w = q(0);
  const Vector<3, Scalar> v(q(1), q(2), q(3));
  Matrix<3, 3, Scalar> R;
  for (Eigen::Index j = 0; j < 3; ++j) {
    for (Eigen::Index i = 0; i < 3; ++i) R(i, j) = Scalar(2) * v(i) * v(j);
  }
  const Scalar even = w * w - squared_norm(v);
  for (Eigen::Index i = 0; i < 3; ++i) R(i, i) += even;
  const Vector<3, Scalar> u = entrywise(v, [&](Eigen::Index i) { return Scalar(2) * w * v(i); });
  R(0, 1) -= u(2);
  R(1, 0) += u(2);
  R(2, 0) -= u(1);
  R(0, 2) += u(1);
  R(1, 2) -= u(0);
  R(2, 1) += u(0);
  return R;
}

/// Rotation matrix of a rotation vector r [rad]: by |r| about r/|r| (Rodrigues).
template <typename Scalar>
[[nodiscard]] Matrix<3, 3, Scalar> rotation(const Vector<3, Scalar>& r) noexcept {
  return rotation(quaternion(r));
}

/// Rotation of the normalised quaternion of R. R must deviate from a rotation by small errors only.
template <typename Scalar>
[[nodiscard]] Matrix<3, 3, Scalar> orthonormal(const Matrix<3, 3, Scalar>& R) noexcept {
  const Vector<4, Scalar> q = quaternion(R);
  const Scalar length = norm(q);
  return rotation(entrywise(q, [&](Eigen::Index i) { return q(i) / length; }));
}

/// The rotation nearest to a matrix (its orthogonal polar factor), accurate to round-off if no entry of RᵀR deviates
/// from the identity by more than 1e-4. A matrix that is orthonormal up to round-off is returned unchanged.
///
/// Two Newton steps X ← (X + X⁻ᵀ)/2: each step squares and halves the deviation of the singular values from 1 (N. J.
/// Higham, Computing the polar decomposition, 1986). An initial deviation of 1.5e-4, the largest for entries of 1e-4,
/// becomes 6e-17.
template <typename Scalar>
[[nodiscard]] Matrix<3, 3, Scalar> nearest_rotation(const Matrix<3, 3, Scalar>& R) noexcept {
  // Largest round-off error of RᵀR [epsilon]: 8 for a product of two rotations, 13 for a product of seven. With 1.6,
  // rounded rotations change, and TargetTurn.* fails.
  constexpr int kRoundOff = 16;
  const Matrix<3, 3, Scalar> excess = R.transpose().lazyProduct(R) - Matrix<3, 3, Scalar>::Identity();
  if (excess.cwiseAbs().maxCoeff() <= Scalar(kRoundOff) * std::numeric_limits<Scalar>::epsilon()) return R;
  Matrix<3, 3, Scalar> X = R;
  for (int step = 0; step < 2; ++step) {
    const Vector<3, Scalar> x = X.col(0);
    const Vector<3, Scalar> y = X.col(1);
    const Vector<3, Scalar> z = X.col(2);
    Matrix<3, 3, Scalar> cofactors;
    cofactors << cross(y, z), cross(z, x), cross(x, y);
    X = (X + cofactors / x.dot(cofactors.col(0))) / Scalar(2);
  }
  return X;
}

}  // namespace fpbm
