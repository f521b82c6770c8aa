#pragma once

#include <algorithm>
#include <cstddef>

#include "fpbm/core/types.hpp"
#include "fpbm/inverse/detail/near_gaps.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/level_space.hpp"
#include "fpbm/linalg/detail/lower_gram.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/task/detail/task_rows.hpp"

namespace fpbm {

/// Solves a level with the damping μ: w = Lᵀ(L Lᵀ + μ I)⁻¹ r, for LevelSpace::add().
template <typename Scalar>
struct SearchDamping {
  Scalar damping;

  template <int M>
  [[nodiscard]] bool operator()(const Matrix<M, M, Scalar>& L, Vector<M, Scalar>& r, Eigen::Index) const noexcept {
    Matrix<M, M, Scalar> gram = lower_gram(L);
    for (Eigen::Index i = 0; i < gram.rows(); ++i) gram.coeffRef(i, i) += damping;
    Cholesky<M, Scalar> factor;
    if (factor.factor(gram) != Status::kOk) return false;
    r = transpose_times(L, factor.solve(r));
    return true;
  }
  /// Every diagonal level is damped.
  [[nodiscard]] static bool loses(Scalar) noexcept { return true; }
};

/// Step of a search, level by level in the null spaces of the levels above:
///
///   Δq ← Δq + Z w,   w = Aᵀ(A Aᵀ + μ I)⁻¹ (e − J Δq),   A = J Z.
///
/// The columns of J of held joints are zero.
template <int N, typename Scalar>
class LevelStep {
 public:
  using JointVector = Vector<N, Scalar>;

  LevelStep(Eigen::Index n, JointBits held) noexcept : space_(n), held_(held), step_(filled<JointVector>(n)) {}

  /// Adds a level with the errors e and the damping μ.
  template <typename Rows, int M>
  void add(const Rows& rows, const Vector<M, Scalar>& e, Scalar damping) noexcept {
    add_rows(matrix_of(rows), e, damping);
  }
  /// Adds a level with the rows of the gaps, as many as memory is reserved for: a level with kMaxDof rows determines
  /// all joints.
  template <typename Rows, int M>
  void add(const Rows& rows, const Vector<M, Scalar>& e, const NearGaps<N, Scalar>& gaps, Scalar damping) noexcept {
    const auto& J = matrix_of(rows);
    const Eigen::Index count = std::min<Eigen::Index>(gaps.count, kMaxDof - e.size());
    Matrix<Eigen::Dynamic, N, Scalar> all(e.size() + count, step_.size());
    Vector<Eigen::Dynamic, Scalar> errors(e.size() + count);
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
      const Eigen::Index gap = i - e.size();
      errors.coeffRef(i) = gap < 0 ? e.coeff(i) : gaps.beyond.coeff(gap);
      for (Eigen::Index j = 0; j < all.cols(); ++j) {
        all.coeffRef(i, j) = gap < 0 ? J.coeff(i, j) : gaps.gradients.coeff(j, gap);
      }
    }
    add_rows(all, errors, damping);
  }

  [[nodiscard]] const JointVector& value() const noexcept { return step_; }

 private:
  template <int M>
  [[nodiscard]] static const Matrix<M, N, Scalar>& matrix_of(const LevelRows<M, N, Scalar>& rows) noexcept {
    return rows.J;
  }
  [[nodiscard]] static Matrix<N, N, Scalar> matrix_of(const PostureRows<N, Scalar>& rows) noexcept {
    auto J = filled<Matrix<N, N, Scalar>>(rows.rows());
    for (Eigen::Index i = 0; i < J.rows(); ++i) J.coeffRef(i, rows.joints[static_cast<std::size_t>(i)]) = Scalar(1);
    return J;
  }

  template <int M>
  void add_rows(Matrix<M, N, Scalar> J, Vector<M, Scalar> e, Scalar damping) noexcept {
    if (space_.rank() == space_.size()) return;
    const Vector<M, Scalar> made = product(J, step_);
    for (Eigen::Index i = 0; i < e.size(); ++i) e.coeffRef(i) -= made.coeff(i);
    each_joint(held_, [&](Eigen::Index j) noexcept {
      for (Eigen::Index i = 0; i < J.rows(); ++i) J.coeffRef(i, j) = Scalar(0);
    });
    SearchDamping<Scalar> solver{damping};
    step_ += space_.add(J, e, solver);
  }

  LevelSpace<N, Scalar> space_;
  JointBits held_;
  JointVector step_;
};

}  // namespace fpbm
