#pragma once

#include <cstddef>
#include <tuple>

#include "fpbm/core/product_space.hpp"
#include "fpbm/realtime/path_follower.hpp"
#include "fpbm/task/reference.hpp"
#include "fpbm/task/target_filter.hpp"

namespace fpbm {

/// A source of references some seconds into the tick.
template <typename Space, typename Scalar>
[[nodiscard]] Reference<Space, Scalar> source_ahead(const Reference<Space, Scalar>& source, Scalar seconds) noexcept {
  return ahead(source, seconds);
}
template <typename Path, typename Scalar>
[[nodiscard]] auto source_ahead(const PathFollower<Path>& source, Scalar seconds) noexcept {
  return source.ahead(seconds);
}
template <typename Space, typename Scalar>
[[nodiscard]] auto source_ahead(const TargetFilter<Space, Scalar>& source, Scalar seconds) noexcept {
  return source.ahead(seconds);
}

/// A source after a tick. follows: the arm follows it; a path follower waits while the arm stops.
template <typename Space, typename Scalar>
void advance_source(const Reference<Space, Scalar>&, Scalar, bool) noexcept {}
template <typename Path, typename Scalar>
void advance_source(PathFollower<Path>& source, Scalar dt, bool follows) noexcept {
  if (follows) source.advance(dt);
}
template <typename Space, typename Scalar>
void advance_source(TargetFilter<Space, Scalar>& source, Scalar, bool) noexcept {
  source.advance();
}

/// The reference of a product of spaces, from a source for each.
template <typename Space, typename Scalar, typename... Sources>
[[nodiscard]] Reference<Space, Scalar> joined(Scalar seconds, const Sources&... sources) noexcept {
  const auto parts = std::make_tuple(source_ahead(sources, seconds)...);
  Reference<Space, Scalar> all = Reference<Space, Scalar>::hold(Space::template origin<Scalar>());
  Space::each([&](auto space, auto i, int row) noexcept {
    using Part = decltype(space);
    constexpr std::size_t kIndex = decltype(i)::value;
    std::get<kIndex>(all.x) = std::get<kIndex>(parts).x;
    all.xd.template segment<Part::kRows>(row) = std::get<kIndex>(parts).xd;
    all.xdd.template segment<Part::kRows>(row) = std::get<kIndex>(parts).xdd;
  });
  return all;
}

}  // namespace fpbm
