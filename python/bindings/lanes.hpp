#pragma once

#include <atomic>
#include <tuple>
#include <type_traits>

#include "arm.hpp"
#include "fpbm/any/any_path.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/sim/time_grid.hpp"
#include "outcome.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

/// Moves one arm as many times as there are lanes, side by side: under schemes[i] from starts[i] at rest. The schemes
/// are of one level and such as runs_in_lanes() accepts. Writes an outcome for each motion; kNotRun for one that was
/// stopped, or that was not regular all the way and must be run by itself.
template <typename Space>
using RunInLanes = void (*)(const Arm& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                            const Scheme* const* schemes, const JointVector* starts, const std::atomic<bool>& stop,
                            Outcome* outcomes);

/// The code in lanes for one kind of processor. Each kind's is a module of its own, so that nothing compiled for a
/// newer processor is ever linked into what runs on every one.
struct LaneCode {
  int lanes;
  std::tuple<RunInLanes<Position<2>>, RunInLanes<Position<3>>, RunInLanes<Pose>> run;
};

/// The arms that there is code in lanes for.
template <typename Space>
using ArmInLanes = std::conditional_t<std::is_same_v<Space, Position<2>>, PlanarArm<4>, SerialArm<7>>;

[[nodiscard]] inline bool runs_in_lanes(const Arm& arm) noexcept {
  if (const auto* chain = std::get_if<Chain<>>(&arm.source)) {
    return arm.dof() == 7 && chain->joints.size() == 7;  // No joint follows another.
  }
  return arm.dof() == 4;
}

[[nodiscard]] inline bool runs_in_lanes(const Scheme& scheme) noexcept {
  return scheme.is_plain() && !std::holds_alternative<Scheme::Dense>(scheme.weights);
}

}  // namespace fpbm::bindings
