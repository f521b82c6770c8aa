#pragma once

#include <utility>
#include <vector>

#include "fpbm/core/lanes.hpp"
#include "fpbm/realtime/tracker_batch.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "lanes.hpp"

namespace fpbm::bindings {

inline constexpr int kLanes = static_cast<int>(std::experimental::native_simd<double>::size());
using InLanes = fpbm::Lanes<kLanes>;

/// A Scalar whose lanes are get(scheme) of the schemes.
template <typename Law, typename Get>
[[nodiscard]] InLanes each(const std::vector<Law>& laws, const Get& get) {
  return InLanes([&](auto lane) { return get(laws[lane]); });
}

template <typename Law>
[[nodiscard]] SingularDamping<InLanes> singular_of(const std::vector<Law>& laws) {
  return SingularDamping<InLanes>(each(laws, [](const Law& law) { return law.singular.radius(); }),
                                  each(laws, [](const Law& law) { return law.singular.brake(); }));
}

template <int N>
[[nodiscard]] VelocityScheme<N, InLanes> side_by_side(const std::vector<VelocityScheme<N>>& laws) {
  using Law = VelocityScheme<N>;
  return VelocityScheme<N, InLanes>(
      DiagonalWeights<N, InLanes>::side_by_side([&](auto lane) -> auto& { return laws[lane].weights; }),
      each(laws, [](const Law& law) { return law.k; }),
      NullSpace<N, InLanes>::side_by_side([&](auto lane) -> auto& { return laws[lane].null_space; }),
      singular_of(laws));
}

template <int N>
[[nodiscard]] AccelerationScheme<N, InLanes> side_by_side(const std::vector<AccelerationScheme<N>>& laws) {
  using Law = AccelerationScheme<N>;
  return {each(laws, [](const Law& law) { return law.alpha; }),
          DiagonalWeights<N, InLanes>::side_by_side([&](auto lane) -> auto& { return laws[lane].weights; }),
          each(laws, [](const Law& law) { return law.k1; }),
          each(laws, [](const Law& law) { return law.k2; }),
          NullSpace<N, InLanes>::side_by_side([&](auto lane) -> auto& { return laws[lane].null_space; }),
          singular_of(laws)};
}

[[nodiscard]] inline MotionSummary<> lane_of(const MotionSummary<InLanes>& all, int lane) noexcept {
  const auto at = static_cast<std::size_t>(lane);
  return {all.max_error[at],         all.max_orientation_error[at], all.peak_velocity[at], all.final_velocity[at],
          all.peak_acceleration[at], all.final_acceleration[at],    all.manipulability[at]};
}

/// RunInLanes for the schemes of one level.
template <typename Space, typename Law>
void run_level(const ArmInLanes<Space>& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
               const std::vector<Law>& laws, const std::vector<Vector<Law::kDof>>& starts,
               TrackersInLanes<Space> trackers, const std::atomic<bool>& stop, Outcome* outcomes) {
  constexpr int N = Law::kDof;
  const auto scheme = side_by_side(laws);
  const auto in_lanes = arm.template cast<InLanes>();
  Summary<Space, N, InLanes> summarise(trackers.empty() ? Law::kLevel : Level::kAcceleration);
  const auto record = [&](const Sample<Space, N, InLanes>& sample) noexcept {
    summarise(sample);
    return !stop.load(std::memory_order_relaxed);
  };
  // status_of(lane): status of the motion in a lane, if no motion was stopped.
  const auto write = [&](int samples, double time, const auto& status_of) {
    const MotionSummary<InLanes> summary = summarise.result();
    for (int lane = 0; lane < kLanes; ++lane) {
      const int status = samples == grid.samples() ? status_of(static_cast<std::size_t>(lane)) : Outcome::kNotRun;
      outcomes[lane] =
          status == Outcome::kNotRun ? Outcome::of_nothing() : Outcome{status, samples, time, lane_of(summary, lane)};
    }
  };
  if (!trackers.empty()) {
    TrackerBatch batch(in_lanes, Space{}, scheme, std::move(trackers));
    const int samples = track_batch(batch, path, grid, record);
    write(samples, grid.time(samples - 1), [&](std::size_t lane) { return static_cast<int>(batch.status()[lane]); });
    return;
  }
  State<N, InLanes> start{Vector<N, InLanes>::Zero(), Vector<N, InLanes>::Zero()};
  for (int i = 0; i < N; ++i) start.q(i) = InLanes([&](auto lane) { return starts[lane](i); });
  const auto result = rollout(in_lanes, path, scheme, start, grid, record);
  const auto regular = isfinite(result.last.q.sum()) && isfinite(result.last.qd.sum());
  write(result.samples, result.time,
        [&](std::size_t lane) { return regular[lane] ? static_cast<int>(Status::kOk) : Outcome::kNotRun; });
}

template <typename Space>
void run_in_lanes(const ArmInLanes<Space>& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                  const SchemesInLanes<Space>& schemes, const std::vector<Vector<ArmInLanes<Space>::kDof>>& starts,
                  TrackersInLanes<Space> trackers, const std::atomic<bool>& stop, Outcome* outcomes) {
  if (schemes.acceleration.empty()) {
    run_level<Space>(arm, path, grid, schemes.velocity, starts, std::move(trackers), stop, outcomes);
  } else {
    run_level<Space>(arm, path, grid, schemes.acceleration, starts, std::move(trackers), stop, outcomes);
  }
}

// In lane_positions.cpp. Positions and poses are compiled in separate units, which limits the memory of the compiler.
[[nodiscard]] RunInLanes<Position<2>> plane_in_lanes() noexcept;
[[nodiscard]] RunInLanes<Position<3>> position_in_lanes() noexcept;

}  // namespace fpbm::bindings
