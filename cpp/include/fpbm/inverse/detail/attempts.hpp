#pragma once

#include <algorithm>

#include "fpbm/core/detail/mask.hpp"

namespace fpbm {

/// Number of steps of an attempt that may be slow before the attempt gives up. Range: 3 to 5, as for the values of
/// Attempts.
inline constexpr int kPatience = 4;

/// Attempts of a search from several postures, one for each lane of the Scalar.
///
/// A step that makes the posture better is taken, and λ decreases. Otherwise, the posture does not change, and λ
/// increases. Search: TipSearch or StackSearch.
template <typename Search>
class Attempts {
 public:
  using Scalar = typename Search::Scalar;
  using Trial = typename Search::Trial;
  using JointVector = typename Search::JointVector;

  explicit Attempts(const Search& search) noexcept : search_(search) {}

  [[nodiscard]] const Trial& now() const noexcept { return now_; }

  /// Starts new attempts from q in the lanes of the mask. patience: number of steps that may be slow.
  void start(const Mask<Scalar>& lanes, const JointVector& q, const Scalar& patience) noexcept {
    Trial trial;
    trial.q = q;
    search_.evaluate(trial);
    search_.take(lanes, trial, now_);
    lambda_ = select(lanes, Scalar(kFirstDamping), lambda_);
    steps_ = select(lanes, Scalar(0), steps_);
    patience_ = select(lanes, patience, patience_);
  }

  /// Starts the attempt from a given start. Near the target, the attempt is patient, since the posture on the branch of
  /// the start is expected, as for the next waypoint of a path.
  void start_given(const JointVector& q) noexcept {
    start(true, q, Scalar(kPatience));
    const Scalar near = Scalar(kNearStart) * search_.length();
    if (now_.cost <= near * near) patience_ = Scalar(kPatienceNear);
  }

  /// One step. Returns the lanes that give up.
  [[nodiscard]] Mask<Scalar> step() noexcept {
    using std::max;
    Trial trial;
    trial.q = search_.step(now_, lambda_);
    search_.evaluate(trial);
    const Mask<Scalar> better = search_.better(trial, now_);
    const Mask<Scalar> slow = trial.cost > Scalar(kSlow) * now_.cost;
    search_.take(better, trial, now_);
    lambda_ = select(better, max(Scalar(lambda_ * Scalar(kLess)), Scalar(kLeastDamping)), lambda_ * Scalar(kMore));
    steps_ += Scalar(1);
    const Mask<Scalar> far = now_.cost > Scalar(kNear) * search_.length() * search_.length();
    return (steps_ > patience_ && slow && far) || steps_ > Scalar(kMostSteps) * patience_;
  }

  /// Moves toward the other tasks while the targets that must be reached stay reached: each step is followed by
  /// corrections without the other tasks.
  void settle() noexcept {
    if constexpr (Search::kHasRest) {
      lambda_ = Scalar(kFirstDamping);
      int slow = 0;
      for (int i = 0; i < kSettling && slow < kSlowSteps && lambda_ < Scalar(kMostDamping); ++i) {
        Trial trial;
        trial.q = search_.step(now_, lambda_);
        search_.evaluate(trial);
        // One correction more than necessary: near a singular posture, an error within the tolerance moves the other
        // tasks by more than the step.
        bool reached = false;
        for (int k = 0; k < kCorrections && !reached; ++k) {
          reached = search_.reached(trial);
          trial.q = search_.correction(trial);
          search_.evaluate(trial);
        }
        const bool better = search_.reached(trial) && trial.rest < now_.rest;
        // A joint that reaches an end of its range makes one step slow.
        if (better) slow = trial.rest > Scalar(kSettled) * now_.rest ? slow + 1 : 0;
        search_.take(better, trial, now_);
        lambda_ *= Scalar(better ? kLess : kMore);
      }
    }
  }

 private:
  // The values are from a random search for the least mean effort over 3,000 reachable poses of each of six arms
  // (`make inverse` prints the mean time). Within the ranges, the effort changes by at most 3 %, and all but 2 of
  // 18,000 poses are found.
  static constexpr double kFirstDamping = 0.1;   ///< λ of the first step. Range: 0.03 to 0.3.
  static constexpr double kLeastDamping = 1e-5;  ///< Least λ. Range: 1e-7 to 1e-3.
  static constexpr double kLess = 0.4;           ///< Factor of λ after a step that is taken. Range: 0.3 to 0.5.
  static constexpr double kMore = 12.0;          ///< Factor of λ after any other step. Range: 4 to 20.
  static constexpr double kSlow = 0.7;           ///< Least ratio of the costs of a slow step. Range: 0.5 to 0.8.
  /// An attempt with a smaller cost, in squares of the characteristic length, does not give up: the target may be near
  /// a singular posture. Without this value, 6 of 30,000 poses of a Panda are not found with 256 starts.
  static constexpr double kNear = 1e-5;
  /// Bound on the steps of an attempt, a multiple of its patience. Range: 16 to 64. With 8, a pose of an FR3 needs 76
  /// starts, with 16, at most 63 (`make inverse`).
  static constexpr double kMostSteps = 16.0;
  /// Patience of start_given() from a start that is nearer than kNearStart characteristic lengths to the target.
  /// Ranges: 12 to 100, and 0.03 to 0.3. Of 80,000 waypoints (`make inverse`), 7 more are not on the branch of their
  /// start with a patience of 4, and 6 more with kNearStart = 0.01.
  static constexpr double kPatienceNear = 32.0;
  static constexpr double kNearStart = 0.05;

  // The values for settle() are choices: InverseOfStacks.approaches_a_posture_below_a_pose prints the slope along the
  // null space at the end.
  static constexpr int kSettling = 40;         ///< Largest number of steps.
  static constexpr int kCorrections = 4;       ///< Largest number of corrections after a step.
  static constexpr int kSlowSteps = 3;         ///< Number of slow steps, one after another, at the end.
  static constexpr double kSettled = 0.9999;   ///< Least ratio of the costs of the other tasks in a slow step.
  static constexpr double kMostDamping = 1e3;  ///< λ at which no step is better.

  const Search& search_;
  Trial now_;
  Scalar lambda_{0};
  Scalar steps_{0};
  Scalar patience_{0};
};

}  // namespace fpbm
