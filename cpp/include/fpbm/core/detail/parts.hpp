#pragma once

#include <type_traits>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Whether a task space is a product of other task spaces (ProductSpace).
template <typename Space, typename = void>
inline constexpr bool kIsProduct = false;
template <typename Space>
inline constexpr bool kIsProduct<Space, std::void_t<decltype(Space::kProduct)>> = true;

/// Number of task levels.
template <typename Space>
inline constexpr int kLevelsOf = 1;

/// Calls f(space, row, first) for each space of a product, or for the space itself. row: index of the first row of the
/// space. first: whether the space belongs to a task of the first level.
template <typename Space, typename F>
void each_part(F&& f) noexcept {
  if constexpr (kIsProduct<Space>) {
    Space::each([&](auto space, auto i, int row) noexcept { f(space, row, decltype(i)::value < Space::kFirst); });
  } else {
    f(Space{}, 0, true);
  }
}

/// Divides the linear rows of a displacement by length [m]. The angular rows do not change.
template <typename Space, int M, typename Scalar>
[[nodiscard]] Vector<M, Scalar> in_lengths(Vector<M, Scalar> twist, Scalar length) noexcept {
  each_part<Space>([&](auto space, int row, bool) noexcept {
    using Part = decltype(space);
    for (int i = row; i < row + Part::kRows - Part::kTurns; ++i) twist(i) /= length;
  });
  return twist;
}

}  // namespace fpbm
