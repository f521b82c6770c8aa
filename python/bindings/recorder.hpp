#pragma once

#include <atomic>

#include "fpbm/sim/motion.hpp"
#include "fpbm/sim/summary.hpp"

namespace fpbm::bindings {

/// What is wanted of a motion, and what ends it before its time; null is left out.
template <typename Space>
struct Wanted {
  MotionBuffers<Space, Eigen::Dynamic> buffers = {};
  MotionSummary<>* summary = nullptr;
  const std::atomic<bool>* stop = nullptr;
};

/// The recorder of every motion: one type, so that a rollout is compiled once for each scheme, whatever is wanted.
template <typename Space, int N>
class Recorder {
 public:
  Recorder(const Wanted<Space>& wanted, Level level)
      : wanted_(wanted),
        buffers_{wanted.buffers.t, wanted.buffers.q,     wanted.buffers.qd,   wanted.buffers.qdd,
                 wanted.buffers.x, wanted.buffers.x_ref, wanted.buffers.error},
        summary_(level) {}

#if defined(__GNUC__)  // Once, and not in every rollout.
  [[gnu::noinline]]
#endif
  bool
  operator()(const Sample<Space, N>& sample) noexcept {
    buffers_(sample);
    if (wanted_.summary != nullptr) summary_(sample);
    return wanted_.stop == nullptr || !wanted_.stop->load(std::memory_order_relaxed);
  }

  /// Hands the summary over.
  void finish() const noexcept {
    if (wanted_.summary != nullptr) *wanted_.summary = summary_.result();
  }

 private:
  Wanted<Space> wanted_;
  MotionBuffers<Space, N> buffers_;
  Summary<Space, N> summary_;
};

}  // namespace fpbm::bindings
