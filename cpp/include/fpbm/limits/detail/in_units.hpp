#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/diagonal_level.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/null_basis.hpp"
#include "fpbm/linalg/detail/self_motion.hpp"
#include "fpbm/linalg/detail/sums.hpp"

/// Rows and null spaces of tasks in the units of the joints: joint motions are divided by the unit of each joint.
namespace fpbm {

template <int M, int N, typename Scalar>
[[nodiscard]] Matrix<M, N, Scalar> in_units(Matrix<M, N, Scalar> J, const Vector<N, Scalar>& unit) noexcept {
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    for (Eigen::Index i = 0; i < J.rows(); ++i) J.coeffRef(i, j) *= unit.coeff(j);
  }
  return J;
}
template <int N, typename Scalar>
[[nodiscard]] DiagonalLevel<N, Scalar> in_units(const DiagonalLevel<N, Scalar>& rows,
                                                const Vector<N, Scalar>& unit) noexcept {
  return {product(rows, unit)};
}

/// Smallest |v|² of a self-motion v in SelfMotion, as a fraction of the largest possible |v|². |v| is then at least
/// 1/100 of its largest possible length, and v has lost at most two digits. `fpbm_tests
/// --gtest_filter='DegenerateSaturation*'` passes with 1e-8 to 1e-2.
template <typename Scalar>
inline constexpr Scalar kRegularSelfMotion = Scalar(1e-4);

/// Sets Z to a basis of the null space of J in the units of the joints. rows: number of rows of Z; the rows below the
/// rows of the joints are not set.
template <int M, int N, typename Scalar, typename Basis>
void set_null_basis(const Matrix<M, N, Scalar>& J, const Vector<N, Scalar>& unit, Eigen::Index rows,
                    Basis& Z) noexcept {
  if constexpr (kHasSelfMotion<M, N>) {  // One self-motion v, away from singular postures: Z is v with length 1.
    SelfMotion<M, N, Scalar> motion;
    for (int kind = 0; kind < motion.kKinds; ++kind) {
      if (!motion.factor(J, kind, kRegularSelfMotion<Scalar>)) continue;
      Z.resize(rows, 1);
      const Vector<N, Scalar> v = motion.null();
      const Vector<N, Scalar> scaled = entrywise(v, [&](Eigen::Index i) { return v.coeff(i) / unit.coeff(i); });
      const Scalar length = norm(scaled);
      for (Eigen::Index i = 0; i < N; ++i) Z.coeffRef(i, 0) = scaled.coeff(i) / length;
      return;
    }
  }
  const RowSpace<M, N, Scalar> space(in_units(J, unit));
  Z.resize(rows, J.cols() - space.rank());
  Vector<N, Scalar> column = unit;
  for (Eigen::Index j = 0; j < Z.cols(); ++j) {
    space.column(space.rank() + j, column.data());
    for (Eigen::Index i = 0; i < J.cols(); ++i) Z.coeffRef(i, j) = column.coeff(i);
  }
}

}  // namespace fpbm
