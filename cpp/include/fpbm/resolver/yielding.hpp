#pragma once

#include "fpbm/core/cholesky.hpp"
#include "fpbm/resolver/limits.hpp"

namespace fpbm {

/// The joint motion within a box that comes near J u = v where it cannot be had in any part,
///
///   min ‖J u − v‖² + μ ‖u − rest‖²,
///
/// by projected gradients from the unbounded solution rest + Jᵀ(JJᵀ + μI)⁻¹(v − J rest), cut to the box: n steps, each
/// of which brings it nearer. A continuous function of all that goes in, unlike a guess at which joints are on their
/// bounds: it does not chatter.
template <int M, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> yielding(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& v, Scalar mu,
                                         const Vector<N, Scalar>& rest, const Box<N, Scalar>& box) noexcept {
  Matrix<M, M, Scalar> gram = J.lazyProduct(J.transpose());
  const Scalar stiffness = gram.trace() + mu;
  gram.diagonal().array() += mu;
  Cholesky<M, Scalar> cholesky;
  Vector<N, Scalar> u = box.nearest(rest);
  if (cholesky.factor(gram) != Status::kOk) return u;
  const Vector<M, Scalar> missing = v - J.lazyProduct(rest);
  u = box.nearest(rest + J.transpose().lazyProduct(cholesky.solve(missing)));
  for (Eigen::Index pass = 0; pass < J.cols(); ++pass) {
    const Vector<M, Scalar> left = v - J.lazyProduct(u);
    const Vector<N, Scalar> step = J.transpose().lazyProduct(left) + mu * (rest - u);
    u = box.nearest(u + step / stiffness);
  }
  return u;
}

}  // namespace fpbm
