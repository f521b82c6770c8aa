#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// The largest angle [rad] by which a joint may move in one step for the step to resolve the motion.
inline constexpr double kLargestTurn = 0.25;

/// Watches an error from sample to sample for the step in which it grows by more than its rate explains.
///
/// From one sample to the next an error e grows by h ė at most and, where the step resolves the motion, by little more:
/// little against the way that the reference went and against the error itself, and by what a fourth-order step
/// truncates. When the arm steps over a singular posture, or the target is out of reach, it grows by as much as the
/// reference went.
template <int M, typename Scalar = double>
class ErrorWatch {
 public:
  using Row = Vector<M, Scalar>;

  /// Whether e came here by its rate of h seconds ago. travel is the way of the reference in between, turn [rad] the
  /// largest step of a joint, size the largest value that a joint adds to what e is a difference of; e's units.
  [[nodiscard]] bool follows(const Row& error, const Row& rate, Scalar h, Scalar travel, Scalar turn,
                             Scalar size) noexcept {
    using std::sqrt;
    const Scalar growth = error.norm() - error_.norm() - h * rate_.norm();
    const Scalar expected = kTolerance * (travel + error.norm() + h * rate.norm());
    const Scalar truncation = turn * (turn * turn) * (turn * turn) * size;
    const Scalar round_off = sqrt(std::numeric_limits<Scalar>::epsilon()) * size;
    const bool follows = !started_ || growth <= expected + truncation + round_off;
    error_ = error;
    rate_ = rate;
    started_ = true;
    return follows;
  }

 private:
  static constexpr Scalar kTolerance = Scalar(0.1);

  bool started_ = false;
  Row error_ = Row::Zero();
  Row rate_ = Row::Zero();
};

}  // namespace fpbm
