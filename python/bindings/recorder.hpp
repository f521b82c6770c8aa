#pragma once

#include <atomic>

#include "arm.hpp"
#include "fpbm/sim/motion.hpp"
#include "fpbm/sim/summary.hpp"

namespace fpbm::bindings {

/// Arrays for a motion, and the condition that ends it early; null is left out.
template <typename Space>
struct Output {
  MotionBuffers<Space, kDynamic> buffers = {};
  double* scale = nullptr;      ///< Scale of each tick of a motion within limits,
  bool* saturated = nullptr;    ///< and a row of joints.
  double* clearance = nullptr;  ///< Distance of the nearest pair, written by the code that computes it.
  double* scales = nullptr;     ///< For a stack: a row of levels,
  double* errors = nullptr;     ///< and the errors of all tasks.
  MotionSummary<>* summary = nullptr;
  const std::atomic<bool>* stop = nullptr;
};

/// The recorder of every motion: one type, so that a rollout is compiled once for all outputs.
template <typename Space>
class Recorder {
 public:
  /// level: whether the samples have accelerations of their own.
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

  /// Hands the summary over.
  void finish() const noexcept {
    if (output_.summary != nullptr) *output_.summary = summary_.result();
  }

 private:
  Output<Space> output_;
  Summary<Space, kDynamic> summary_;
};

}  // namespace fpbm::bindings
