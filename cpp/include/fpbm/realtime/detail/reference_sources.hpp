#pragma once

#include <algorithm>
#include <type_traits>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/path/path_follower.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
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
/// waits, and a TargetFilter continues. fraction: Tick::path_fraction, which slows the clock of a kept path, also while
/// the arm stops.
template <typename Space, typename Scalar>
void advance_source(const Reference<Space, Scalar>&, Scalar, bool, Scalar) noexcept {}
template <typename Path, typename Scalar>
void advance_source(PathFollower<Path>& source, Scalar dt, bool stopping, Scalar fraction) noexcept {
  if (source.keeps_path()) {
    source.advance(dt, fraction);
  } else if (!stopping) {
    source.advance(dt);
  }
}
template <typename Space, typename Scalar>
void advance_source(TargetFilter<Space, Scalar>& source, Scalar, bool, Scalar) noexcept {
  source.advance();
}

/// Largest fraction of the displacement along a kept path in the coming tick (PathFollower::most_fraction()); 0 for
/// another source. While the arm stops, the clock of a kept path stops.
template <typename Scalar, typename Source>
[[nodiscard]] Scalar most_path_fraction(Source&, Scalar, bool) noexcept {
  return Scalar(0);
}
template <typename Scalar, typename Path>
[[nodiscard]] Scalar most_path_fraction(PathFollower<Path>& source, Scalar dt, bool stopping) noexcept {
  if (!source.keeps_path()) return Scalar(0);
  source.hold(stopping);
  return source.most_fraction(dt);
}

/// Reference of a single task from its source. The overload for StackSpace has a source for each task.
template <typename Space, typename Scalar, typename Source, typename = std::enable_if_t<!kIsProduct<Space>>>
[[nodiscard]] Reference<Space, Scalar> joined(Space, Scalar seconds, const Source& source) noexcept {
  return source_ahead(source, seconds);
}

/// References of a tick of dt [s] from its sources.
template <typename Space, typename Scalar, typename... Sources>
[[nodiscard]] TickReferences<Space, Scalar> references_of(Space, Scalar dt, bool stopping,
                                                          Sources&... sources) noexcept {
  const Scalar most = std::max({most_path_fraction(sources, dt, stopping)...});
  auto references =
      TickReferences<Space, Scalar>::of([&](Scalar t) noexcept { return joined(Space{}, t, sources...); }, dt);
  references.most_path_fraction = most;
  return references;
}

}  // namespace fpbm
