#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "fpbm/core/lanes.hpp"
#include "fpbm/sim/rollout.hpp"
#include "lanes.hpp"

namespace fpbm::bindings {

inline constexpr int kLanes = static_cast<int>(std::experimental::native_simd<double>::size());
using InLanes = fpbm::Lanes<kLanes>;

/// Every scheme of acceleration is an FPBM: MAN (8) has no share of WMVN and no feedback.
template <int N>
[[nodiscard]] FPBM<N> as_fpbm(const MAN<N>& man) {
  return {0.0, DiagonalWeights<N>(Vector<N>::Ones()), 0.0, 0.0, man.null_space, man.singular};
}
template <int N>
[[nodiscard]] FPBM<N> as_fpbm(const FPBM<N>& scheme) {
  return scheme;
}

/// A Scalar of what get(scheme) is of each.
template <typename Scheme, typename Get>
[[nodiscard]] InLanes each(const std::vector<Scheme>& schemes, const Get& get) {
  return InLanes([&](auto lane) { return get(schemes[lane]); });
}

template <typename Scheme>
[[nodiscard]] SingularDamping<InLanes> singular_of(const std::vector<Scheme>& schemes) {
  return SingularDamping<InLanes>(each(schemes, [](const Scheme& scheme) { return scheme.singular.radius(); }),
                                  each(schemes, [](const Scheme& scheme) { return scheme.singular.brake(); }));
}

template <int N>
[[nodiscard]] FPBM<N, InLanes> side_by_side(const std::vector<FPBM<N>>& schemes) {
  using Scheme = FPBM<N>;
  return {each(schemes, [](const Scheme& scheme) { return scheme.alpha; }),
          DiagonalWeights<N, InLanes>::side_by_side([&](auto lane) -> auto& { return schemes[lane].weights; }),
          each(schemes, [](const Scheme& scheme) { return scheme.k1; }),
          each(schemes, [](const Scheme& scheme) { return scheme.k2; }),
          NullSpace<N, InLanes>::side_by_side([&](auto lane) -> auto& { return schemes[lane].null_space; }),
          singular_of(schemes)};
}

template <int N>
[[nodiscard]] WMVN<N, InLanes> side_by_side(const std::vector<WMVN<N>>& schemes) {
  using Scheme = WMVN<N>;
  return WMVN<N, InLanes>(
      DiagonalWeights<N, InLanes>::side_by_side([&](auto lane) -> auto& { return schemes[lane].weights; }),
      each(schemes, [](const Scheme& scheme) { return scheme.k; }),
      NullSpace<N, InLanes>::side_by_side([&](auto lane) -> auto& { return schemes[lane].null_space; }),
      singular_of(schemes));
}

/// Sums up, and ends the motions once it is told to.
template <typename Space, int N>
struct LaneRecorder {
  Summary<Space, N, InLanes> summary;
  const std::atomic<bool>& stop;

  bool operator()(const Sample<Space, N, InLanes>& sample) noexcept {
    summary(sample);
    return !stop.load(std::memory_order_relaxed);
  }
};

[[nodiscard]] inline MotionSummary<> lane_of(const MotionSummary<InLanes>& all, int lane) noexcept {
  const auto at = static_cast<std::size_t>(lane);
  return {all.max_error[at],     all.max_orientation_error[at], all.peak_velocity[at], all.final_velocity[at],
          all.peak_acceleration[at], all.final_acceleration[at], all.manipulability[at]};
}

template <typename Arm, typename Space, typename Scheme>
void run_side_by_side(const Arm& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                      const std::vector<Scheme>& schemes, const Vector<Eigen::Dynamic>* starts,
                      const std::atomic<bool>& stop, Outcome* outcomes) {
  constexpr int N = Arm::kDof;
  State<N, InLanes> start{Vector<N, InLanes>::Zero(), Vector<N, InLanes>::Zero()};
  for (int i = 0; i < N; ++i) start.q(i) = InLanes([&](auto lane) { return starts[lane](i); });
  LaneRecorder<Space, N> record{Summary<Space, N, InLanes>(Scheme::kLevel), stop};
  const auto result = rollout(arm.template cast<InLanes>(), path, side_by_side(schemes), start, grid, record);
  const MotionSummary<InLanes> summary = record.summary.result();
  const auto regular = isfinite(result.last.q.sum()) && isfinite(result.last.qd.sum());
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool done = result.samples == grid.samples() && regular[static_cast<std::size_t>(lane)];
    outcomes[lane] = done ? Outcome{static_cast<int>(Status::kOk), result.samples, result.time, lane_of(summary, lane)}
                          : Outcome::of_nothing();
  }
}

template <typename Arm, typename Space>
void run_in_lanes(const Arm& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                  const PyScheme* const* schemes, const Vector<Eigen::Dynamic>* starts, const std::atomic<bool>& stop,
                  Outcome* outcomes) {
  constexpr int N = Arm::kDof;
  std::vector<FPBM<N>> accelerations;
  std::vector<WMVN<N>> velocities;
  for (int lane = 0; lane < kLanes; ++lane) {
    schemes[lane]->visit_core<N>(arm.limits(), [&](const auto& scheme) {
      using Scheme = std::decay_t<decltype(scheme)>;
      if constexpr (std::is_same_v<Scheme, WMVN<N>>) velocities.push_back(scheme);
      if constexpr (std::is_same_v<Scheme, FPBM<N>> || std::is_same_v<Scheme, MAN<N>>) {
        accelerations.push_back(as_fpbm<N>(scheme));
      }
    });
  }
  if (velocities.empty()) {
    run_side_by_side(arm, path, grid, accelerations, starts, stop, outcomes);
  } else {
    run_side_by_side(arm, path, grid, velocities, starts, stop, outcomes);
  }
}

}  // namespace fpbm::bindings
