#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Distance in a task space that adds lengths and angles: ‖(Δp/length, Δφ)‖, with the arm's characteristic length [m]
/// and angles in radians.
template <typename Space, typename Scalar>
struct TaskDistance {
  using Twist = Vector<Space::kRows, Scalar>;
  using Point = typename Space::template Point<Scalar>;

  [[nodiscard]] static Scalar norm(Twist twist, Scalar length) noexcept {
    twist.template head<Space::kRows - Space::kTurns>() /= length;
    return twist.norm();
  }

  [[nodiscard]] static Scalar of(const Point& x, const Point& y, Scalar length) noexcept {
    return norm(Space::template difference<Scalar>(x, y), length);
  }
};

}  // namespace fpbm
