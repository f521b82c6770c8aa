#pragma once

#include <atomic>
#include <limits>
#include <tuple>
#include <type_traits>
#include <vector>

#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/scheme/acceleration_scheme.hpp"
#include "fpbm/scheme/velocity_scheme.hpp"
#include "fpbm/simulate/summary.hpp"
#include "fpbm/simulate/time_grid.hpp"
#include "postures.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {

/// The outcome of a motion. The numbers are NaN if the motion was not run or has no sample.
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

/// The type of the arms with code in lanes.
template <typename Space>
using ArmInLanes = std::conditional_t<std::is_same_v<Space, Position<2>>, PlanarArm<4>, SerialArm<7>>;

/// One scheme for each lane, all of one level; the list of the other level is empty.
template <typename Space>
struct SchemesInLanes {
  static constexpr int N = ArmInLanes<Space>::kDof;
  std::vector<VelocityScheme<N>> velocity;
  std::vector<AccelerationScheme<N>> acceleration;
};

template <typename Space>
using TrackersInLanes = std::vector<LaneTracker<Space, ArmInLanes<Space>::kDof>>;

/// Runs one motion of an arm in each lane, from the start of the lane at rest, under the scheme of the lane; with
/// trackers, within limits. Writes an outcome for each motion. The status is kNotRun if the motion was stopped, or if a
/// motion without limits is not finite up to its end and must be run without lanes.
template <typename Space>
using RunInLanes = void (*)(const ArmInLanes<Space>& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                            const SchemesInLanes<Space>& schemes,
                            const std::vector<Vector<ArmInLanes<Space>::kDof>>& starts, TrackersInLanes<Space> trackers,
                            const std::atomic<bool>& stop, Outcome* outcomes);

/// The code in lanes for one kind of processor. The code of each kind is a separate module, so that the linker never
/// puts functions for a newer processor into code for all processors.
struct LaneCode {
  int lanes;
  std::tuple<RunInLanes<Position<2>>, RunInLanes<Position<3>>, RunInLanes<Pose>> run;
  std::tuple<PosturesInLanes<6>, PosturesInLanes<7>> postures;
};

/// The selected code in lanes, or null.
inline const LaneCode* selected_lanes = nullptr;

}  // namespace fpbm::bindings
