#pragma once

#include <limits>

#include "fpbm/sim/summary.hpp"

namespace fpbm::bindings {

/// What became of a motion. Not a number where there is none: of a motion that was not run, or has no sample.
struct Outcome {
  static constexpr int kNotRun = -1;
  [[nodiscard]] static Outcome of_nothing() noexcept {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNotRun, 0, kNone, {kNone, kNone, kNone, kNone, kNone, kNone, kNone}};
  }

  int status;  ///< A Status, or kNotRun.
  int samples;
  double time;  ///< Of the last sample [s].
  MotionSummary<> summary;
};

}  // namespace fpbm::bindings
