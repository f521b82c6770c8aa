#pragma once

#include <algorithm>
#include <type_traits>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/path/path_follower.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
#include "fpbm/target/stream.hpp"
#include "fpbm/target/target_filter.hpp"

/// Sources of references for a tick: a Reference, which continues at constant acceleration, a PathFollower, a
/// TargetFilter, or a Stream.
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

/// Advances a source after a tick of dt [s] at a level. stopping: whether the arm stops. While the arm stops, a
/// PathFollower waits, and a TargetFilter or a Stream continues. fraction: Tick::path_fraction, which slows the clock of a kept
/// path, also while the arm stops.
template <typename Space, typename Scalar>
void advance_source(const Reference<Space, Scalar>&, Scalar, Level, bool, Scalar) noexcept {}
template <typename Path, typename Scalar>
void advance_source(PathFollower<Path>& source, Scalar dt, Level level, bool stopping, Scalar fraction) noexcept {
  if (source.kept() != nullptr) {
    source.advance(dt, fraction, level);
  } else if (!stopping) {
    source.advance(dt);
  }
}
template <typename Space, typename Scalar>
void advance_source(TargetFilter<Space, Scalar>& source, Scalar, Level, bool, Scalar) noexcept {
  source.advance();
}

template <typename Space, typename Scalar, int kPoints>
void advance_source(Stream<Space, Scalar, kPoints>& source, Scalar, Level, bool, Scalar) noexcept {
  source.advance();
}

/// Sets the speed of a source before a tick, if the speed is not 0.
template <typename Space, typename Scalar>
void set_source_speed(const Reference<Space, Scalar>&, Scalar) noexcept {}
template <typename Path, typename Scalar>
void set_source_speed(PathFollower<Path>& source, Scalar speed) noexcept {
  if (speed != Scalar(0)) source.set_speed(speed);
}
template <typename Space, typename Scalar>
void set_source_speed(TargetFilter<Space, Scalar>& source, Scalar speed) noexcept {
  if (speed != Scalar(0)) source.set_speed(speed);
}
template <typename Space, typename Scalar, int kPoints>
void set_source_speed(Stream<Space, Scalar, kPoints>& source, Scalar speed) noexcept {
  if (speed != Scalar(0)) source.set_speed(speed);
}

/// Whether a source may follow a kept path.
template <typename Source>
inline constexpr bool kMayKeep = false;
template <typename Path>
inline constexpr bool kMayKeep<PathFollower<Path>> = kMayBeKept<Path>;

/// Limits the rate of the clock of a kept path before a tick: to 0 while the arm stops, and before postures that are
/// closer to the bounds than planned, since an obstacle has moved. q: posture of the arm.
template <typename Source, typename Bounds_, typename JointVector>
void look_ahead(Source&, bool, Bounds_&, const JointVector&) noexcept {}
template <typename Path, typename Bounds_, typename JointVector, typename = std::enable_if_t<kMayBeKept<Path>>>
void look_ahead(PathFollower<Path>& source, bool stopping, Bounds_& bounds, const JointVector&) noexcept {
  const KeptMotion* const kept = source.kept();
  if (kept == nullptr) return;
  double rate = stopping ? 0.0 : 1.0;
  if (!stopping && !bounds.empty()) {
    const double t = source.stop_time();
    const auto q = kept->template posture<JointVector::RowsAtCompileTime>(t);
    rate = kept->rate(t, bounds.closeness(q, KeptMotion::kRange));
  }
  source.limit_rate(rate);
}

/// Sets the planned state of the joints on a kept path.
template <typename Source, typename JointState>
void take_planned_state(const Source&, JointState&) noexcept {}
template <typename Path, typename JointState, typename = std::enable_if_t<kMayBeKept<Path>>>
void take_planned_state(const PathFollower<Path>& source, JointState& planned) noexcept {
  if (source.kept() == nullptr) return;
  planned = source.template planned<std::decay_t<decltype(planned.q)>::RowsAtCompileTime>();
}

/// Largest Tick::path_fraction of a kept path in the coming tick (PathFollower::most_fraction()); 0 for another source.
template <typename Source, typename Scalar>
[[nodiscard]] Scalar most_path_fraction(const Source&, Scalar) noexcept {
  return Scalar(0);
}
template <typename Path, typename Scalar>
[[nodiscard]] Scalar most_path_fraction(const PathFollower<Path>& source, Scalar) noexcept {
  return source.kept() != nullptr ? source.most_fraction() : Scalar(0);
}

/// Reference of a single task from its source. The overload for StackSpace has a source for each task.
template <typename Space, typename Scalar, typename Source, typename = std::enable_if_t<!kIsProduct<Space>>>
[[nodiscard]] Reference<Space, Scalar> joined(Space, Scalar seconds, const Source& source) noexcept {
  return source_ahead(source, seconds);
}

/// References of a tick of dt [s] from its sources: PathReferences if a source may follow a kept path.
template <typename Space, typename Scalar, typename... Sources>
[[nodiscard]] auto references_of(Space, Scalar dt, const Sources&... sources) noexcept {
  const auto references =
      TickReferences<Space, Scalar>::of([&](Scalar t) noexcept { return joined(Space{}, t, sources...); }, dt);
  if constexpr ((kMayKeep<Sources> || ...)) {
    Scalar most(0);
    ((most = std::max(most, most_path_fraction(sources, dt))), ...);
    return PathReferences<Space, Scalar>{references, most};
  } else {
    return references;
  }
}

}  // namespace fpbm
