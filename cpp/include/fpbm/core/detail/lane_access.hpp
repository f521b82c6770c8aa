#pragma once

#include <cstddef>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

/// Access to single SIMD lanes of matrices and poses whose Scalar holds several numbers.
namespace fpbm {

/// One lane of a Scalar, or the Scalar itself if it is a single number.
template <typename Scalar>
[[nodiscard]] Number<Scalar> number_of_lane(const Scalar& all, [[maybe_unused]] std::size_t lane) noexcept {
  if constexpr (kInLanes<Scalar>) {
    return all[lane];
  } else {
    return all;
  }
}

template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Number<Scalar>> lane_of(const Matrix<Rows, Cols, Scalar>& all,
                                                         std::size_t lane) noexcept {
  Matrix<Rows, Cols, Number<Scalar>> one(all.rows(), all.cols());
  for (Eigen::Index i = 0; i < all.size(); ++i) one(i) = number_of_lane(all(i), lane);
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

/// Number of lanes of a Scalar; 1 for a single number.
template <typename Scalar>
inline constexpr std::size_t kLanesOf = sizeof(Scalar) / sizeof(Number<Scalar>);

/// 0, 1, 2, … in the lanes of a Scalar.
template <typename Scalar>
[[nodiscard]] Scalar lane_numbers() noexcept {
  if constexpr (kInLanes<Scalar>) {
    return Scalar([](auto lane) { return Number<Scalar>(lane); });
  } else {
    return Scalar(0);
  }
}

/// Calls f(lane) for each lane of the Scalar whose mask is true.
template <typename Scalar, typename F>
void each_lane(const Mask<Scalar>& mask, F&& f) noexcept {
  if constexpr (kInLanes<Scalar>) {
    if (none_of(mask)) return;
    for (std::size_t lane = 0; lane < kLanesOf<Scalar>; ++lane) {
      if (mask[lane]) f(lane);
    }
  } else {
    if (mask) f(std::size_t(0));
  }
}

/// Sets one lane of a mask to true.
template <typename Scalar>
void set_true(Mask<Scalar>& mask, [[maybe_unused]] std::size_t lane) noexcept {
  if constexpr (kInLanes<Scalar>) {
    mask[lane] = true;
  } else {
    mask = true;
  }
}

}  // namespace fpbm
