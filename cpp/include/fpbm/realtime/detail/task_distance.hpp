#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// Distance in a task space with lengths and angles: ‖(Δp/length, Δφ)‖, with the arm's characteristic length [m] and
/// angles in radians. For a stack, only the tasks of the first level count.
template <typename Space, typename Scalar>
struct TaskDistance {
  using Twist = Vector<Space::kRows, Scalar>;
  using Point = typename Space::template Point<Scalar>;

  /// Smallest displacement of a target that counts as a motion, and largest step of progress.
  /// `fpbm_tests --gtest_filter='Stall.lasts*:Stall.is_not*'` passes with 5e-4 and 2e-3. With 2e-4, the noise of a
  /// target counts as a motion; with 8e-3, a slow approach counts as a stall.
  static constexpr Scalar kProgress = Scalar(2e-3);

  /// Decrease of a distance that counts as progress. The quarter, for distances below 0.008, is not tuned.
  [[nodiscard]] static Scalar step(Scalar distance) noexcept { return std::min(kProgress, distance / Scalar(4)); }

  [[nodiscard]] static Scalar norm(Twist twist, Scalar length) noexcept {
    each_part<Space>([&](auto space, int row, bool first) noexcept {
      using Part = decltype(space);
      for (int i = row; i < row + Part::kRows - Part::kTurns; ++i) twist(i) /= length;
      for (int i = row; !first && i < row + Part::kRows; ++i) twist(i) = Scalar(0);
    });
    using std::sqrt;
    return sqrt(entrywise(twist, [&](Eigen::Index i) { return twist.coeff(i) * twist.coeff(i); }).sum());
  }

  [[nodiscard]] static Scalar between(const Point& x, const Point& y, Scalar length) noexcept {
    return norm(Space::template difference<Scalar>(x, y), length);
  }
};

}  // namespace fpbm
