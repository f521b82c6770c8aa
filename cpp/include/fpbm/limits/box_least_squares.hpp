#pragma once

#include <algorithm>

#include "fpbm/limits/box.hpp"
#include "fpbm/linalg/cholesky.hpp"

namespace fpbm {

/// The joint motion within a box that comes nearest to J u = v where the box does not admit it:
///
///   min ‖J u − v‖² + μ ‖u − rest‖²,
///
/// from the unbounded solution rest + Jᵀ(JJᵀ + μI)⁻¹(v − J rest), clipped to the box, then by Gauss-Seidel: n
/// rounds, each of which moves every joint in turn to its best place within its bounds. A continuous function of all
/// inputs, unlike an active set, so that it does not chatter.
template <int M, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> box_least_squares(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& v, Scalar mu,
                                                  const Vector<N, Scalar>& rest, const Box<N, Scalar>& box) noexcept {
  Matrix<M, M, Scalar> gram = J.lazyProduct(J.transpose());
  gram.diagonal().array() += mu;
  Cholesky<M, Scalar> cholesky;
  if (cholesky.factor(gram) != Status::kOk) return box.nearest(rest);
  const Vector<M, Scalar> missing = v - J.lazyProduct(rest);
  Vector<N, Scalar> u = box.nearest(rest + J.transpose().lazyProduct(cholesky.solve(missing)));
  Vector<M, Scalar> left = v - J.lazyProduct(u);
  const Vector<N, Scalar> curvature = J.colwise().squaredNorm().transpose().array() + mu;
  for (Eigen::Index round = 0; round < J.cols(); ++round) {
    for (Eigen::Index i = 0; i < J.cols(); ++i) {
      const Scalar slope = J.col(i).dot(left) + mu * (rest(i) - u(i));
      const Scalar to = std::clamp(u(i) + slope / curvature(i), box.lower(i), box.upper(i));
      left -= (to - u(i)) * J.col(i);
      u(i) = to;
    }
  }
  return u;
}

}  // namespace fpbm
