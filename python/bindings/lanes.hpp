#pragma once

#include <atomic>
#include <tuple>
#include <type_traits>

#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/sim/time_grid.hpp"
#include "outcome.hpp"
#include "path.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

/// As many motions of an arm along a path as there are lanes, side by side: schemes[i] from starts[i] at rest, all
/// schemes of one level and with what runs_in_lanes() asks. Writes an outcome for each; kNotRun for one that was
/// stopped, or was not regular all the way and is to be run by itself.
template <typename Arm, typename Space>
using RunInLanes = void (*)(const Arm& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                            const PyScheme* const* schemes, const Vector<Eigen::Dynamic>* starts,
                            const std::atomic<bool>& stop, Outcome* outcomes);

/// The code in lanes for one kind of processor. Each kind's is a module of its own, so that nothing compiled for a
/// newer processor is ever linked into what runs on every one.
struct LaneCode {
  int lanes;
  std::tuple<RunInLanes<PlanarArm<4>, Position<2>>, RunInLanes<SerialArm<7>, Position<3>>,
             RunInLanes<SerialArm<7>, Pose>>
      run;
};

/// The code for this processor; null where there is none.
[[nodiscard]] const LaneCode* lane_code() noexcept;
void use_lane_code(const LaneCode* code) noexcept;

template <typename T, typename Tuple>
inline constexpr bool kIsIn = false;
template <typename T, typename... Types>
inline constexpr bool kIsIn<T, std::tuple<Types...>> = (std::is_same_v<T, Types> || ...);

/// The code for an arm and a task, or null.
template <typename Arm, typename Space>
[[nodiscard]] RunInLanes<Arm, Space> run_in_lanes() noexcept {
  using Run = RunInLanes<Arm, Space>;
  if constexpr (kIsIn<Run, decltype(LaneCode::run)>) {
    return lane_code() == nullptr ? nullptr : std::get<Run>(lane_code()->run);
  } else {
    return nullptr;
  }
}

[[nodiscard]] inline bool runs_in_lanes(const PyScheme& scheme) noexcept {
  return !scheme.has_wrappers() && !std::holds_alternative<PyScheme::Dense>(scheme.weights);
}

}  // namespace fpbm::bindings
