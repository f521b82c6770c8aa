#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/core/validation.hpp"

namespace fpbm {

/// Notices an arm that comes no nearer to its target, which may be out of reach.
///
/// Progress is an error that is smaller than any before by 0.002, or a target that has moved by 0.002, in the arm's
/// characteristic lengths and in radians. The arm has stalled where there is none for stall_time. It goes on once its
/// target has moved, or shapes beside it.
template <typename Space, typename Scalar = double>
class StallDetector {
 public:
  using Twist = Vector<Space::kRows, Scalar>;
  using Point = typename Space::template Point<Scalar>;

  /// stall_time: [s], infinite for never. Throws std::invalid_argument unless positive.
  StallDetector(Scalar stall_time, Scalar dt) : stall_time_(stall_time), dt_(dt) {
    if (!(stall_time > Scalar(0))) {
      validation::fail("stall_time", stall_time, "positive, or infinite");
    }
  }

  [[nodiscard]] bool stalled() const noexcept { return waited_ > stall_time_; }

  /// One more tick that does not do its whole task. length: the arm's characteristic length.
  void update(const Point& target, const Twist& error, Scalar length) noexcept {
    const Scalar size = norm(error, length);
    if (size < kStep || size < least_ - kStep ||
        norm(Space::template difference<Scalar>(target, target_), length) > kStep) {
      target_ = target;
      least_ = size;
      waited_ = Scalar(0);
    } else {
      waited_ += dt_;
    }
  }

  /// One more tick of an arm that has stalled: once it has come to rest, it is to try again where shapes near it have
  /// moved. room: a measure of how far they are from it.
  void wait(bool at_rest, Scalar room, Scalar length) noexcept {
    using std::abs;
    if (rests_ && abs(room - room_) > kStep * length) return reset();
    if (at_rest && !rests_) room_ = room;
    rests_ = rests_ || at_rest;
  }

  /// The arm is to try again.
  void reset() noexcept {
    rests_ = false;
    least_ = std::numeric_limits<Scalar>::infinity();
    waited_ = Scalar(0);
  }

 private:
  [[nodiscard]] static Scalar norm(Twist twist, Scalar length) noexcept {
    for (int i = 0; i < Space::kRows - Space::kTurns; ++i) twist(i) /= length;
    return twist.norm();
  }

  static constexpr Scalar kStep = Scalar(2e-3);  ///< Of progress. Smaller errors do not count.

  Scalar stall_time_;
  Scalar dt_;
  Scalar waited_ = Scalar(0);  ///< Without progress [s].
  Scalar least_ = std::numeric_limits<Scalar>::infinity();
  bool rests_ = false;       ///< Since it stalled, it has come to rest.
  Scalar room_ = Scalar(0);  ///< When it did.
  Point target_ = Space::template origin<Scalar>();
};

}  // namespace fpbm
