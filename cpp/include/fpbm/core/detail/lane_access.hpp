#pragma once

#include <cstddef>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

/// Access to single SIMD lanes of matrices and poses whose Scalar holds several numbers.
namespace fpbm {

template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Number<Scalar>> lane_of(const Matrix<Rows, Cols, Scalar>& all,
                                                         std::size_t lane) noexcept {
  Matrix<Rows, Cols, Number<Scalar>> one(all.rows(), all.cols());
  for (Eigen::Index i = 0; i < all.size(); ++i) one(i) = all(i)[lane];
  return one;
}
template <typename Scalar>
[[nodiscard]] Transform<Number<Scalar>> lane_of(const Transform<Scalar>& all, std::size_t lane) noexcept {
  return {lane_of(all.p, lane), lane_of(all.R, lane)};
}

template <int Rows, int Cols, typename Scalar>
void set_lane(Matrix<Rows, Cols, Scalar>& all, std::size_t lane,
              const Matrix<Rows, Cols, Number<Scalar>>& one) noexcept {
  for (Eigen::Index i = 0; i < all.size(); ++i) all(i)[lane] = one(i);
}
template <typename Scalar>
void set_lane(Transform<Scalar>& all, std::size_t lane, const Transform<Number<Scalar>>& one) noexcept {
  set_lane(all.p, lane, one.p);
  set_lane(all.R, lane, one.R);
}

}  // namespace fpbm
