#pragma once

#include "fpbm/core/cholesky.hpp"
#include "fpbm/resolver/limits.hpp"

namespace fpbm {

/// The joint motion within a box that comes near J u = v where it cannot be had in any part: damped least squares,
///
///   min ‖J u − v‖² + μ ‖u − rest‖²,   u = rest + Jᵀ(JJᵀ + μI)⁻¹(v − J rest),
///
/// where joints that would leave the box are held on its border and the others solved for again; n passes at most.
/// Returns rest, within the box, where there is no solution.
template <int M, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> yielding(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& v, Scalar mu,
                                         const Vector<N, Scalar>& rest, const Box<N, Scalar>& box) noexcept {
  Matrix<M, N, Scalar> free = J;  // Columns of held joints are zero.
  Vector<N, Scalar> u = rest;
  for (Eigen::Index pass = 0; pass < J.cols(); ++pass) {
    Matrix<M, M, Scalar> gram = free.lazyProduct(free.transpose());
    gram.diagonal().array() += mu;
    Cholesky<M, Scalar> cholesky;
    if (cholesky.factor(gram) != Status::kOk) break;
    const Vector<M, Scalar> left = v - J.lazyProduct(u);
    const Vector<N, Scalar> wanted = u + free.transpose().lazyProduct(cholesky.solve(left));
    const Vector<N, Scalar> kept = box.nearest(wanted);
    bool all = true;
    for (Eigen::Index i = 0; i < J.cols(); ++i) {
      if (kept(i) == wanted(i)) continue;
      u(i) = kept(i);
      free.col(i).setZero();
      all = false;
    }
    if (all) return kept;
  }
  return box.nearest(rest);
}

}  // namespace fpbm
