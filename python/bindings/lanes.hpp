#pragma once

#include <atomic>
#include <limits>
#include <tuple>
#include <type_traits>
#include <vector>

#include "fpbm/any/any_path.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/scheme/acceleration_scheme.hpp"
#include "fpbm/scheme/velocity_scheme.hpp"
#include "fpbm/sim/summary.hpp"
#include "fpbm/sim/time_grid.hpp"
#include "lane_tracker.hpp"

namespace fpbm::bindings {

/// The outcome of a motion. Not a number where there is none: of a motion that was not run, or has no sample.
struct Outcome {
  static constexpr int kNotRun = -1;
  [[nodiscard]] static Outcome of_nothing() noexcept {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNotRun, 0, kNone, {kNone, kNone, kNone, kNone, kNone, kNone, kNone}};
  }

  int status;  ///< A Status, or kNotRun.
  int samples;
  double time;  ///< Time of the last sample [s].
  MotionSummary<> summary;
};

/// The arms that there is code in lanes for.
template <typename Space>
using ArmInLanes = std::conditional_t<std::is_same_v<Space, Position<2>>, PlanarArm<4>, SerialArm<7>>;

/// As many schemes as there are lanes, all of one level: the list of the other is empty.
template <typename Space>
struct SchemesInLanes {
  static constexpr int N = ArmInLanes<Space>::kDof;
  std::vector<VelocityScheme<N>> velocity;
  std::vector<AccelerationScheme<N>> acceleration;
};

template <typename Space>
using TrackersInLanes = std::vector<LaneTracker<Space, ArmInLanes<Space>::kDof>>;

/// Moves one arm as many times as there are lanes, side by side: under each scheme from its start, at rest; within
/// limits where there is a tracker for each. Writes an outcome for each motion; kNotRun for one that was stopped, or
/// that was not regular up to its end and must be run by itself, as none within limits is.
template <typename Space>
using RunInLanes = void (*)(const ArmInLanes<Space>& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                            const SchemesInLanes<Space>& schemes,
                            const std::vector<Vector<ArmInLanes<Space>::kDof>>& starts, TrackersInLanes<Space> trackers,
                            const std::atomic<bool>& stop, Outcome* outcomes);

/// The code in lanes for one kind of processor. Each kind's is a module of its own, so that nothing compiled for a
/// newer processor is ever linked into code for every processor.
struct LaneCode {
  int lanes;
  std::tuple<RunInLanes<Position<2>>, RunInLanes<Position<3>>, RunInLanes<Pose>> run;
};

}  // namespace fpbm::bindings
