#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// Task space of M joint positions. All rows count as angles [rad].
template <int M>
struct JointSpace {
  static constexpr int kRows = M;
  static constexpr int kTurns = M;
  static constexpr int kSize = M;

  template <typename Scalar>
  using Point = Vector<M, Scalar>;

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return filled<Point<Scalar>>(M);
  }

  template <typename Scalar>
  [[nodiscard]] static Vector<M, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    return entrywise(x, [&](Eigen::Index i) { return x.coeff(i) - y.coeff(i); });
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<M, Scalar>& d) noexcept {
    return entrywise(y, [&](Eigen::Index i) { return y.coeff(i) + d.coeff(i); });
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> compose(const Point<Scalar>& y, const Point<Scalar>& x) noexcept {
    return displace<Scalar>(y, x);
  }

  template <typename Scalar>
  static void store(const Point<Scalar>& x, Scalar* out) noexcept {
    for (int i = 0; i < M; ++i) out[i] = x(i);
  }
};

/// Whether a task space is a JointSpace.
template <typename Space>
inline constexpr bool kIsJointSpace = false;
template <int M>
inline constexpr bool kIsJointSpace<JointSpace<M>> = true;

}  // namespace fpbm
