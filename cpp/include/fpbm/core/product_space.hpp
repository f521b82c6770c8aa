#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/core/types.hpp"

namespace fpbm {

template <typename Space, typename = void>
inline constexpr bool kIsProduct = false;
template <typename Space>
inline constexpr bool kIsProduct<Space, std::void_t<decltype(Space::kProduct)>> = true;

/// Number of task levels.
template <typename Space>
inline constexpr int kLevelsOf = 1;

/// Task space of several tasks: a point of each. Rows are those of the spaces one after another.
///
/// The first kFirst spaces are those of the first level.
template <int First, typename... Spaces>
struct ProductSpace {
  static constexpr bool kProduct = true;
  static constexpr int kFirst = First;
  static constexpr int kRows = (Spaces::kRows + ...);
  static constexpr int kSize = (Spaces::kSize + ...);

  template <typename Scalar>
  using Point = std::tuple<typename Spaces::template Point<Scalar>...>;

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return {Spaces::template origin<Scalar>()...};
  }

  template <typename Scalar>
  [[nodiscard]] static Vector<kRows, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    Vector<kRows, Scalar> result;
    each([&](auto space, auto i, auto row) noexcept {
      using Space = decltype(space);
      result.template segment<Space::kRows>(row) =
          Space::template difference<Scalar>(std::get<decltype(i)::value>(x), std::get<decltype(i)::value>(y));
    });
    return result;
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<kRows, Scalar>& d) noexcept {
    Point<Scalar> result = y;
    each([&](auto space, auto i, auto row) noexcept {
      using Space = decltype(space);
      const Vector<Space::kRows, Scalar> part = d.template segment<Space::kRows>(row);
      auto& point = std::get<decltype(i)::value>(result);
      point = Space::template displace<Scalar>(point, part);
    });
    return result;
  }

  /// Calls f(space, i, row) for each space: i is its index as a type, row the index of its first row.
  template <typename F>
  static void each(F&& f) noexcept {
    each(f, std::index_sequence_for<Spaces...>{});
  }

 private:
  template <typename F, std::size_t... i>
  static void each(F& f, std::index_sequence<i...>) noexcept {
    int row = 0;
    ((f(Spaces{}, std::integral_constant<std::size_t, i>{}, row), row += Spaces::kRows), ...);
  }
};

/// The single space itself, or the spaces of a product: calls f(space, row, first), where row is the index of its first
/// row, and first says whether it belongs to the first level.
template <typename Space, typename F>
void each_part(F&& f) noexcept {
  if constexpr (kIsProduct<Space>) {
    Space::each([&](auto space, auto i, int row) noexcept { f(space, row, decltype(i)::value < Space::kFirst); });
  } else {
    f(Space{}, 0, true);
  }
}

/// A displacement with its lengths in units of a length [m].
template <typename Space, int M, typename Scalar>
[[nodiscard]] Vector<M, Scalar> in_lengths(Vector<M, Scalar> twist, Scalar length) noexcept {
  each_part<Space>([&](auto space, int row, bool) noexcept {
    using Part = decltype(space);
    for (int i = row; i < row + Part::kRows - Part::kTurns; ++i) twist(i) /= length;
  });
  return twist;
}

}  // namespace fpbm
