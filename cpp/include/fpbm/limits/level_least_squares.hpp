#pragma once

#include <algorithm>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/limits/box.hpp"
#include "fpbm/limits/rows.hpp"
#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/level_space.hpp"

namespace fpbm {

/// The motion of a task level within bounds that comes nearest to the level's command, in the null space of the levels
/// above. With an orthonormal basis Z of that null space, in the units of the joints, A = J Z and rest = Zᵀ(calm −
/// from),
///
///   u = from + Z y,    min ‖A y − r‖² + μ ‖y − rest‖²  within the bounds,    r = J (goal − from).
///
/// The dual of the problem is solved by Hildreth's method, n rounds of one step for each bound; what the last step
/// leaves beyond a bound is scaled back toward `from`, which is within all bounds. So u is a continuous function of all
/// inputs, unlike the result of an active set, and no J_i u of a higher level changes.
///
/// Z, J: in units.
template <int M, int N, int P, typename Scalar>
[[nodiscard]] Vector<N, Scalar> level_least_squares(const typename LevelSpace<N, Scalar>::Basis& Z,
                                                    const Matrix<M, N, Scalar>& J, const Vector<N, Scalar>& unit,
                                                    const Box<N, Scalar>& box, const Rows<N, P, Scalar>& rows,
                                                    const Vector<N, Scalar>& from, const Vector<N, Scalar>& goal,
                                                    const Vector<N, Scalar>& calm, Scalar radius) noexcept {
  using Free = Vector<Eigen::Dynamic, Scalar>;
  const Eigen::Index n = from.size();
  const Eigen::Index free = Z.cols();
  Eigen::Index bounds = n;
  if constexpr (P > 0) bounds += rows.count;

  const auto in_units = [&](const Vector<N, Scalar>& v) { return Vector<N, Scalar>(v.cwiseQuotient(unit)); };
  const Vector<M, Scalar> r = J.lazyProduct(in_units(goal - from));
  const Free rest = Z.transpose().lazyProduct(in_units(calm - from));
  const Matrix<M, Eigen::Dynamic, Scalar> A = J.lazyProduct(Z);
  const Scalar mu = radius * radius * J.squaredNorm();
  Matrix<Eigen::Dynamic, Eigen::Dynamic, Scalar> H = A.transpose().lazyProduct(A);
  for (Eigen::Index i = 0; i < free; ++i) H(i, i) += mu;
  Cholesky<Eigen::Dynamic, Scalar> cholesky;
  if (cholesky.factor(H) != Status::kOk) return from;
  Free y = cholesky.solve(Free(A.transpose().lazyProduct(r) + mu * rest));

  // Bound k is lower(k) ≤ c_k · y ≤ upper(k), where c_k is a row of Z or of a further bound.
  using Bounds = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor | Eigen::DontAlign, kCapacity<N>,
                               kCapacity<N> + P>;
  using PerBound = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor | Eigen::DontAlign, kCapacity<N> + P, 1>;
  Bounds c(free, bounds);
  Bounds way(free, bounds);  // H⁻¹ c_k
  PerBound lower(bounds);
  PerBound upper(bounds);
  PerBound gain(bounds);
  PerBound multiplier = PerBound::Zero(bounds);
  for (Eigen::Index k = 0; k < bounds; ++k) {
    if (k < n) {
      c.col(k) = Z.row(k).transpose();
      lower(k) = (box.lower(k) - from(k)) / unit(k);
      upper(k) = (box.upper(k) - from(k)) / unit(k);
    } else if constexpr (P > 0) {
      c.col(k) = Z.transpose().lazyProduct(Vector<N, Scalar>(rows.g.col(k - n).cwiseProduct(unit)));
      lower(k) = -std::numeric_limits<Scalar>::infinity();
      upper(k) = std::max(-rows.excess(k - n, from), Scalar(0));
    }
    const Free column = c.col(k);
    way.col(k) = cholesky.solve(column);
    gain(k) = column.dot(way.col(k));
  }
  const auto rounds = [&]() noexcept {
    for (Eigen::Index round = 0; round < n; ++round) {
      for (Eigen::Index k = 0; k < bounds; ++k) {
        if (!(gain(k) > Scalar(0))) continue;
        const Scalar without = c.col(k).dot(y) + multiplier(k) * gain(k);
        const Scalar next = (without - std::clamp(without, lower(k), upper(k))) / gain(k);
        y -= (next - multiplier(k)) * way.col(k);
        multiplier(k) = next;
      }
    }
  };
  rounds();
  // Once more within bounds that are tighter by what is left beyond them: then little is to be scaled back.
  const PerBound high = upper;
  const PerBound low = lower;
  for (Eigen::Index k = 0; k < bounds; ++k) {
    const Scalar along = c.col(k).dot(y);
    upper(k) = std::max(std::min(high(k), Scalar(2) * high(k) - along), Scalar(0));
    lower(k) = std::min(std::max(low(k), Scalar(2) * low(k) - along), Scalar(0));
  }
  rounds();
  Scalar share(1);
  for (Eigen::Index k = 0; k < bounds; ++k) {
    const Scalar along = c.col(k).dot(y);
    const Scalar most = std::max(along > Scalar(0) ? high(k) : -low(k), Scalar(0));
    if (share * std::abs(along) > most) share = most / std::abs(along);
  }
  return from + unit.cwiseProduct(Vector<N, Scalar>(Z.lazyProduct(Free(share * y))));
}

}  // namespace fpbm
