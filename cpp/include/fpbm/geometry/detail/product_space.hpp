#pragma once

#include <tuple>
#include <utility>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Task space of several tasks: a point is a tuple of one point of each space, and the rows of the spaces are stacked.
///
/// The first kFirst spaces belong to the first task level.
template <int First, typename... Spaces>
struct ProductSpace {
  static constexpr bool kProduct = true;
  static constexpr int kFirst = First;
  static constexpr int kRows = (Spaces::kRows + ...);

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

  /// Calls f(space, i, row) for each space. i is the index of the space as a std::integral_constant. row is the index
  /// of the first row of the space.
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

}  // namespace fpbm
