#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/rotation.hpp"

/// Checks and corrections of points that come from outside of the library.
namespace fpbm {

/// Whether a point is finite, and no entry of RᵀR deviates from the identity by more than 1e-4. A reflection is not a
/// point. An R with 5 decimals is accepted: rounding changes RᵀR by at most 2√3 · 5e-6 = 1.7e-5.
template <typename Derived>
[[nodiscard]] bool is_point(const Eigen::MatrixBase<Derived>& x) noexcept {
  return x.allFinite();
}
template <typename Scalar>
[[nodiscard]] bool is_point(const Transform<Scalar>& x) noexcept {
  const Matrix<3, 3, Scalar> excess = x.R.transpose().lazyProduct(x.R) - Matrix<3, 3, Scalar>::Identity();
  const Scalar handed = x.R.col(0).dot(cross<Scalar>(x.R.col(1), x.R.col(2)));
  return x.p.allFinite() && excess.cwiseAbs().maxCoeff() <= Scalar(1e-4) && handed > Scalar(0);
}

/// The point with the rotation nearest to its R.
template <typename Derived>
[[nodiscard]] typename Derived::PlainObject orthonormalised(const Eigen::MatrixBase<Derived>& x) noexcept {
  return x;
}
template <typename Scalar>
[[nodiscard]] Transform<Scalar> orthonormalised(const Transform<Scalar>& x) noexcept {
  return {x.p, nearest_rotation(x.R)};
}

/// The point with R corrected to a rotation up to round-off.
template <typename Derived>
[[nodiscard]] typename Derived::PlainObject straightened(const Eigen::MatrixBase<Derived>& x) noexcept {
  return x;
}
template <typename Scalar>
[[nodiscard]] Transform<Scalar> straightened(const Transform<Scalar>& x) noexcept {
  return {x.p, orthonormal(x.R)};
}

/// Largest magnitude of a coordinate of a point, for bounds on the round-off error.
template <typename Derived>
[[nodiscard]] typename Derived::Scalar extent(const Eigen::MatrixBase<Derived>& x) noexcept {
  return x.cwiseAbs().maxCoeff();
}
template <typename Scalar>
[[nodiscard]] Scalar extent(const Transform<Scalar>& x) noexcept {
  return std::max(extent(x.p), Scalar(1));
}

/// Requires at least two points of a path, and finite numbers.
template <typename Space, typename Scalar>
void require_points(const std::vector<typename Space::template Point<Scalar>>& points) {
  if (points.size() < 2) {
    validation::reject("points", " has ", points.size(), " entries: must have at least 2");
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    Scalar numbers[Space::kSize];
    Space::store(points[i], numbers);
    for (int k = 0; k < Space::kSize; ++k) {
      const validation::Argument point = validation::element("points", static_cast<Eigen::Index>(i));
      validation::require_finite(validation::element(point, k), numbers[k]);
    }
  }
}

}  // namespace fpbm
