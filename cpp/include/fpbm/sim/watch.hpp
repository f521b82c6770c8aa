#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Watches a rollout from sample to sample for the step in which the tip leaves the course its scheme prescribes.
///
/// From one sample to the next the tip error e goes by h ė and, where the step resolves the motion, by little more:
/// little against the way that the reference went and the error itself. When the arm steps over a singular posture,
/// or the target is out of reach, the difference is as large as the step.
template <int M, typename Scalar = double>
class TaskWatch {
 public:
  using Row = Vector<M, Scalar>;

  /// Compares e and ė [m, m/s] at this sample with those at the one before, h seconds ago; travel [m] is the way of the
  /// reference in between, reach [m] the scale of round-off.
  [[nodiscard]] Status check(const Row& error, const Row& error_rate, Scalar h, Scalar travel, Scalar reach) noexcept {
    using std::sqrt;
    const Scalar jump = (error - error_ - h * error_rate_).norm();
    const Scalar scale = travel + error_.norm() + h * error_rate_.norm();
    const Scalar round_off = sqrt(std::numeric_limits<Scalar>::epsilon()) * reach;
    const bool lost = started_ && !(jump <= kTolerance * scale + round_off);
    error_ = error;
    error_rate_ = error_rate;
    started_ = true;
    return lost ? Status::kTaskLost : Status::kOk;
  }

 private:
  static constexpr Scalar kTolerance = Scalar(0.1);

  bool started_ = false;
  Row error_ = Row::Zero();
  Row error_rate_ = Row::Zero();
};

}  // namespace fpbm
