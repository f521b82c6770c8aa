#pragma once

#include <type_traits>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/path/path_follower.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/target/target_filter.hpp"

/// Sources of references for a tick: a Reference, which continues at constant acceleration, a PathFollower, or a
/// TargetFilter.
namespace fpbm {

/// The reference after `seconds` [s] of the tick.
template <typename Space, typename Scalar>
[[nodiscard]] Reference<Space, Scalar> source_ahead(const Reference<Space, Scalar>& source, Scalar seconds) noexcept {
  return ahead(source, seconds);
}
template <typename Source, typename Scalar>
[[nodiscard]] auto source_ahead(const Source& source, Scalar seconds) noexcept {
  return source.ahead(seconds);
}

/// Advances a source after a tick of dt [s]. stopping: whether the arm stops. While the arm stops, a PathFollower
/// waits, and a TargetFilter continues.
template <typename Space, typename Scalar>
void advance_source(const Reference<Space, Scalar>&, Scalar, bool) noexcept {}
template <typename Path, typename Scalar>
void advance_source(PathFollower<Path>& source, Scalar dt, bool stopping) noexcept {
  if (!stopping) source.advance(dt);
}
template <typename Space, typename Scalar>
void advance_source(TargetFilter<Space, Scalar>& source, Scalar, bool) noexcept {
  source.advance();
}

/// Reference of a single task from its source. The overload for StackSpace has a source for each task.
template <typename Space, typename Scalar, typename Source, typename = std::enable_if_t<!kIsProduct<Space>>>
[[nodiscard]] Reference<Space, Scalar> joined(Space, Scalar seconds, const Source& source) noexcept {
  return source_ahead(source, seconds);
}

}  // namespace fpbm
