#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "fpbm/core/detail/lane_access.hpp"
#include "fpbm/core/detail/parts.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/inverse/detail/attempts.hpp"
#include "fpbm/inverse/detail/joint_ranges.hpp"
#include "fpbm/inverse/detail/start_search.hpp"

namespace fpbm {

template <typename Scalar = double>
struct InverseOptions {
  /// Largest distance [m] and angle [rad] of a solution from its target.
  Scalar tolerance = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-6) : Scalar(1e-4);
  int starts = 64;         ///< Largest number of start postures, the given start included.
  std::uint32_t seed = 0;  ///< Selects the start postures after the given start. The same seed gives the same result.
};

/// Result of InverseKinematics::solve().
template <int N, typename Scalar = double>
struct Posture {
  Vector<N, Scalar> q;  ///< The posture, or the nearest posture found [rad] or [m].
  Status status;        ///< kOk, kNotFound, or kNotFinite if the target or the start is not finite.
  Scalar error;         ///< Largest distance [m] or angle [rad] from the target.
  int starts;           ///< Number of start postures used.

  [[nodiscard]] bool solved() const noexcept { return status == Status::kOk; }
};

/// Postures for targets: inverse kinematics within the ranges of the joints (docs/inverse.md).
///
/// From the given start, and then from start postures that fill the ranges evenly, a search makes steps of Levenberg
/// and Marquardt, until the target is reached. Most attempts that would not reach the target are given up after few
/// steps. The result depends on the arguments only. Memory and time are bounded; there is no heap allocation.
///
///   InverseKinematics inverse(arm, Pose{});                 // the tip of an arm
///   InverseKinematics inverse(robot, stack, {}, limits, bounds);  // a stack of tasks, within bounds
///
/// Batch: Lanes<K> of fpbm/core/lanes.hpp for attempts from K start postures in parallel, for the tip of an arm.
template <typename Arm, typename Space, typename Batch = typename Arm::Scalar, typename Bounds_ = Bounds<>>
class InverseKinematics {
 public:
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  using JointVector = Vector<N, Scalar>;
  using Point = typename Space::template Point<Scalar>;
  using Result = Posture<N, Scalar>;
  using Limits_ = JointLimits<N, Scalar>;

  /// The tip of an arm. Throws std::invalid_argument if an option is out of range, or a joint has no range.
  InverseKinematics(const Arm& arm, Space, const InverseOptions<Scalar>& options = {})
      : InverseKinematics(arm, options, arm.limits(), {}) {}
  /// limits: only the ranges are used.
  InverseKinematics(const Arm& arm, Space, const InverseOptions<Scalar>& options, const Limits_& limits)
      : InverseKinematics(arm, options, limits, {}) {}

  /// A stack of tasks of a robot, within bounds. Throws as above, and if a task does not suit the robot.
  template <typename Robot_, typename... Levels>
  InverseKinematics(const Robot_& robot, const Stack<Levels...>& stack, const InverseOptions<Scalar>& options = {})
      : InverseKinematics(Arm(robot, stack), options, robot.limits(), {}) {}
  template <typename Robot_, typename... Levels>
  InverseKinematics(const Robot_& robot, const Stack<Levels...>& stack, const InverseOptions<Scalar>& options,
                    const Limits_& limits, const Bounds_& bounds = {})
      : InverseKinematics(Arm(robot, stack), options, limits, bounds) {}

  /// A posture for the target. start: the first posture from which the search starts, moved into the ranges. From a
  /// start near the target, the result is the nearest posture.
  [[nodiscard]] Result solve(const Point& target, const JointVector& start) noexcept {
    return search(target, start, [](const Result&) noexcept { return true; });
  }

  /// Points of the tasks in the posture q, in the base frame.
  [[nodiscard]] Point tip(const JointVector& q) const noexcept { return kinematics_at(q).tip; }
  /// Manipulability of the tip, or of the first level of a stack, in the posture q.
  [[nodiscard]] Scalar manipulability(const JointVector& q) const noexcept {
    return fpbm::manipulability(kinematics_at(q));
  }

  /// Calls found(posture) for the solution of each attempt, until found() returns true or all starts are used. Returns
  /// the last solution, or if there is none, the nearest posture found.
  template <typename Found>
  Result search(const Point& target, const JointVector& start, const Found& found) noexcept {
    const One one = make_search<One>(arm_, target);
    const JointVector inside = ranges_.clamp(start);
    Attempts first(one);
    first.start_given(inside);
    if (!is_finite(start) || !std::isfinite(first.now().cost)) {
      return {start, Status::kNotFinite, std::numeric_limits<Scalar>::infinity(), 1};
    }
    while (!one.reached(first.now()) && !first.step()) {
    }
    Result result{start, Status::kNotFound, Scalar(0), 1};
    typename One::Trial best = first.now();
    if (one.reached(best)) {
      first.settle();
      result = posture(first.now().q, Status::kOk, target, start, 1);
      if (found(result)) return result;
    }
    const Many many = make_search<Many>(batch_, target);
    StartSearch<Many> starts(many, ranges_, inside, Scalar(options_.seed), 1, options_.starts);
    starts.run(
        [&](const JointVector& q) noexcept {
          result = posture(q, Status::kOk, target, start, starts.used());
          return found(result);
        },
        [&](const typename Many::Trial& now, std::size_t lane) noexcept { keep_better<Many>(one, now, lane, best); });
    if (result.solved()) return result;
    return posture(best.q, Status::kNotFound, target, start, starts.used());
  }

 private:
  using One = SearchOf<Arm, Space, Bounds_>;
  using BatchArm = decltype(arm_in<Batch>(std::declval<const Arm&>()));
  using Many = SearchOf<BatchArm, Space, Bounds_>;

  InverseKinematics(const Arm& arm, const InverseOptions<Scalar>& options, const Limits_& limits, const Bounds_& bounds)
      : arm_(arm), batch_(arm_in<Batch>(arm)), options_(options), bounds_(bounds), ranges_{limits.lower, limits.upper} {
    validation::require_positive("tolerance", options_.tolerance);
    if (options_.starts < 1) validation::fail("starts", options_.starts, "at least 1");
    ranges_.require_sound(arm_.dof());
    length_ = kinematics_at(filled<JointVector>(arm_.dof())).length;
    ranges_.examine([&](const JointVector& q, const JointVector& moved) noexcept {
      const auto change = Space::template difference<Scalar>(kinematics_at(moved).tip, kinematics_at(q).tip);
      return norm(change) / (Scalar(1) + length_);
    });
    if constexpr (kIsProduct<Space>) {
      // A turn of a leader by 2π may turn its followers, which move no task, by another angle toward a bound.
      if (arm_.robot().drives().follows()) ranges_.periodic = 0;
    }
    searched_ = ranges_.of_search();
  }

  template <typename Search, typename Arm_>
  [[nodiscard]] Search make_search(const Arm_& arm, const Point& target) noexcept {
    using In = typename Search::Scalar;
    using Joints = typename Search::JointVector;
    const auto ends = [](const JointVector& q) noexcept {
      return Joints(entrywise_as<In>(q, [&](Eigen::Index i) { return In(q.coeff(i)); }));
    };
    const Joints lower = ends(searched_.lower);
    const Joints upper = ends(searched_.upper);
    if constexpr (Search::kHasRest) {
      return Search(arm, length_, bounds_, lower, upper, target, options_.tolerance);
    } else {
      typename Space::template Point<In> targets;
      if constexpr (kInLanes<In>) {
        for (std::size_t lane = 0; lane < kLanesOf<In>; ++lane) set_lane(targets, lane, target);
      } else {
        targets = target;
      }
      return Search(arm, In(length_), lower, upper, targets, In(options_.tolerance));
    }
  }

  [[nodiscard]] Kinematics<Space, N, Scalar> kinematics_at(const JointVector& q) const noexcept {
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(q, kinematics);
    return kinematics;
  }
  [[nodiscard]] Result posture(const JointVector& q, Status status, const Point& target, const JointVector& start,
                               int starts) const noexcept {
    const JointVector near = ranges_.near(q, start);
    return {near, status, One::largest_error(kinematics_at(near), target), starts};
  }

  Arm arm_;
  BatchArm batch_;
  InverseOptions<Scalar> options_;
  Bounds_ bounds_;
  JointRanges<N, Scalar> ranges_;
  JointRanges<N, Scalar> searched_;  ///< JointRanges::of_search().
  Scalar length_{1};                 ///< Characteristic length [m].
};

template <typename Arm, typename Space, typename... More>
InverseKinematics(const Arm&, Space, const InverseOptions<typename Arm::Scalar>&, const More&...)
    -> InverseKinematics<Arm, Space>;
template <typename Robot_, typename... Levels>
InverseKinematics(const Robot_&, const Stack<Levels...>&, const InverseOptions<typename Robot_::Scalar>& = {})
    -> InverseKinematics<RobotTasks<Robot_, Stack<Levels...>>, StackSpace<Levels...>>;
template <typename Robot_, typename... Levels, typename Bounds_ = Bounds<>>
InverseKinematics(const Robot_&, const Stack<Levels...>&, const InverseOptions<typename Robot_::Scalar>&,
                  const JointLimits<Robot_::kDof, typename Robot_::Scalar>&, const Bounds_& = {})
    -> InverseKinematics<RobotTasks<Robot_, Stack<Levels...>>, StackSpace<Levels...>, typename Robot_::Scalar, Bounds_>;

}  // namespace fpbm
