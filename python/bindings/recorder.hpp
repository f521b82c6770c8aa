#pragma once

#include <atomic>

#include "arm.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/summary.hpp"

namespace fpbm::bindings {

/// Arrays for a motion, and the flag that ends the motion early. A null pointer means no array or no flag.
template <typename Space>
struct Output {
  MotionBuffers<Space, kDynamic> buffers = {};
  double* scale = nullptr;      ///< Within limits: scale of each tick.
  bool* saturated = nullptr;    ///< Within limits: which joints are on a bound, a row for each tick.
  double* clearance = nullptr;  ///< Distance of the nearest pair, written by the code that computes it.
  double* scales = nullptr;     ///< For a stack: scale of each level, a row for each tick.
  double* errors = nullptr;     ///< For a stack: errors of all tasks, a row for each tick.
  MotionSummary<>* summary = nullptr;
  const std::atomic<bool>* stop = nullptr;
};

/// The recorder of every motion: one type, so that a rollout is compiled once for all outputs.
template <typename Space>
class Recorder {
 public:
  /// level: at acceleration level, the samples have accelerations.
  Recorder(const Output<Space>& output, Level level) : output_(output), summary_(level) {}

  bool operator()(const Sample<Space, kDynamic>& sample) noexcept {
    output_.buffers(sample);
    if (output_.summary != nullptr) summary_(sample);
    return output_.stop == nullptr || !output_.stop->load(std::memory_order_relaxed);
  }

  template <typename AnyTick>
  bool operator()(const Sample<Space, kDynamic>& sample, const AnyTick& tick) noexcept {
    if (output_.scale != nullptr) output_.scale[sample.index] = tick.scale;
    if (output_.saturated != nullptr) {
      const Eigen::Index n = sample.q.size();
      for (Eigen::Index i = 0; i < n; ++i) output_.saturated[sample.index * n + i] = ((tick.saturated >> i) & 1U) != 0;
    }
    return (*this)(sample);
  }

  /// Writes the summary to the output.
  void finish() const noexcept {
    if (output_.summary != nullptr) *output_.summary = summary_.result();
  }

 private:
  Output<Space> output_;
  Summary<Space, kDynamic> summary_;
};

}  // namespace fpbm::bindings
