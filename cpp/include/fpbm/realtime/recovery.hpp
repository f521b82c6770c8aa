#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/realtime/task_distance.hpp"

namespace fpbm {

/// Leads an arm out of a posture in which it stands still away from its target, a local minimum of the error: a singular
/// posture with Jᵀe = 0, or joints at the ends of their ranges.
///
/// The arm remembers postures in which it did its task whole, kPostures of them, as far apart as possible. Where it has
/// stalled and one of them is nearer to the target than the arm ever came, the joints move straight to that posture, and
/// the scheme goes on from there. Each recovery lowers the least error by more than a step, so that there are finitely
/// many for a target at rest, and none for a target that is out of reach and whose nearest point the arm has come to.
template <typename Space, int N, typename Scalar = double>
class Recovery {
 public:
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using Point = typename Space::template Point<Scalar>;
  using Distance = TaskDistance<Space, Scalar>;

  /// start, tip: a posture that the arm is in, and its tip there. patience: how long the joints may come no nearer to
  /// the posture that they move to [s].
  explicit Recovery(const JointVector& start, Scalar patience, Scalar dt) noexcept
      : goal_(start), last_(start), patience_(patience), dt_(dt) {}

  [[nodiscard]] bool active() const noexcept { return active_; }
  void end() noexcept { active_ = false; }

  /// Whether a posture is far enough from the last one that was remembered to be worth a look.
  [[nodiscard]] bool is_new(const JointVector& q) const noexcept {
    return count_ == 0 || (q - last_).cwiseAbs().maxCoeff() > kApart;
  }

  /// A posture in which the task is done whole. tip: the tip there. Where all places are taken, the nearest two of all
  /// become one: the newer.
  void remember(const JointVector& q, const Point& tip, Scalar length) noexcept {
    last_ = q;
    for (int i = 0; i < count_; ++i) {
      if (Distance::of(known_[i].tip, tip, length) < kSpread) return;
    }
    int place = count_;
    Scalar least = std::numeric_limits<Scalar>::infinity();
    for (int i = 0; count_ == kPostures && i < count_; ++i) {
      for (int j = 0; j < i; ++j) {
        const Scalar gap = Distance::of(known_[i].tip, known_[j].tip, length);
        if (gap < least) least = gap, place = known_[i].since < known_[j].since ? i : j;
      }
    }
    if (place == count_) ++count_;
    known_[place] = {q, tip, ++clock_};
  }

  /// The target has moved: all postures may be tried again.
  void forget_tries() noexcept {
    near_tried_ = false;
    bar_ = std::numeric_limits<Scalar>::infinity();
  }

  /// Starts toward the remembered posture whose tip is nearest to a target, where the arm has stalled with some error.
  bool begin(const JointVector& q, const Point& target, Scalar length, Scalar error) noexcept {
    int best = -1;
    Scalar least = std::numeric_limits<Scalar>::infinity();
    for (int i = 0; i < count_; ++i) {
      const Scalar gap = Distance::of(target, known_[i].tip, length);
      if (!(gap < least)) continue;
      least = gap;
      best = i;
    }
    if (best < 0) return false;
    const bool nearer = least < std::min(error, bar_) - kStep;
    if (!nearer && (near_tried_ || least > kNear)) return false;
    if (!nearer) near_tried_ = true;
    bar_ = least;
    goal_ = known_[best].q;
    first_ = least_ = (goal_ - q).norm();
    waited_ = Scalar(0);
    arrived_ = false;
    active_ = first_ > Scalar(0.01);
    return active_;
  }

  /// One more tick toward the goal, at the end of which the arm is at q. False where it has arrived, or comes no nearer.
  bool advance(const JointVector& q) noexcept {
    const Scalar left = (goal_ - q).norm();
    if (left < least_ - kShare * first_) {
      least_ = left;
      waited_ = Scalar(0);
    } else {
      waited_ += dt_;
    }
    arrived_ = left <= kArrived * first_;
    active_ = !arrived_ && waited_ <= patience_;
    return active_;
  }
  [[nodiscard]] bool arrived() const noexcept { return arrived_; }

  /// Motion of the joints toward the goal, in a straight line: velocities v = r (goal − q), at a rate r at which each
  /// joint keeps its bound on velocity and can stop; or accelerations toward v.
  template <Level kLevel>
  [[nodiscard]] JointVector motion(const Limits<kLevel, N, Scalar>& limits, const JointState& state) const noexcept {
    const auto& bounds = limits.bounds();
    const JointVector way = goal_ - state.q;
    Scalar rate = kRate;
    for (Eigen::Index i = 0; i < way.size(); ++i) {
      const Scalar length = std::abs(way(i));
      if (rate * length > bounds.velocity(i)) rate = bounds.velocity(i) / length;
      if (rate * rate * length > bounds.acceleration(i)) rate = std::sqrt(bounds.acceleration(i) / length);
    }
    if constexpr (kLevel == Level::kVelocity) return rate * way;
    return Scalar(4) * kRate * (rate * way - state.qd);
  }

 private:
  static constexpr int kPostures = 8;
  static constexpr Scalar kApart = Scalar(0.1);
  static constexpr Scalar kSpread = Scalar(0.05);
  static constexpr Scalar kNear = Scalar(0.3);
  static constexpr Scalar kStep = Scalar(2e-3);
  static constexpr Scalar kRate = Scalar(2);
  static constexpr Scalar kShare = Scalar(0.01);
  static constexpr Scalar kArrived = Scalar(0.02);

  struct Known {
    JointVector q;
    Point tip;
    long since;
  };

  std::array<Known, kPostures> known_;
  int count_ = 0;
  long clock_ = 0;
  JointVector goal_;
  JointVector last_;
  Scalar patience_;
  Scalar dt_;
  Scalar first_ = Scalar(0);
  Scalar least_ = Scalar(0);
  Scalar waited_ = Scalar(0);
  bool active_ = false;
  bool arrived_ = false;
  bool near_tried_ = false;
  Scalar bar_ = std::numeric_limits<Scalar>::infinity();
};

}  // namespace fpbm
