#pragma once

#include <algorithm>

#include "fpbm/limits/box.hpp"
#include "fpbm/linalg/cholesky.hpp"

namespace fpbm {

/// The joint motion within a box that comes near J u = v where it cannot be had in any part,
///
///   min ‖J u − v‖² + μ ‖u − rest‖²,
///
/// from the unbounded solution rest + Jᵀ(JJᵀ + μI)⁻¹(v − J rest), cut to the box, by moving one joint after another to
/// where it is best within its bounds (Gauss and Seidel), n rounds of n steps each. A continuous function of all that
/// goes in, unlike a guess at which joints are on their bounds: it does not chatter.
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
