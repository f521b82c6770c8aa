#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/inverse/detail/level_step.hpp"
#include "fpbm/inverse/detail/near_gaps.hpp"
#include "fpbm/inverse/detail/search_error.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/task/detail/robot_tasks.hpp"

namespace fpbm {

/// Search of postures for a stack of tasks, within bounds (docs/inverse.md, Several tasks). Has the members of
/// TipSearch. Arm: RobotTasks.
///
/// The tasks of the first level, and all tasks except postures, must reach their targets. A posture below the first
/// level is approached as far as the other tasks allow.
template <typename Arm, typename Bounds_>
class StackSearch {
 public:
  using Scalar = typename Arm::Scalar;
  using Stack_ = std::decay_t<decltype(std::declval<const Arm&>().stack())>;
  using Space = typename Stack_::Space;
  static constexpr int N = Arm::kDof;
  static constexpr bool kHasRest = true;
  using JointVector = Vector<N, Scalar>;
  using Point = typename Stack_::Point;

  template <std::size_t... k>
  static std::tuple<Vector<Stack_::kRows[k], Scalar>...> errors_of(std::index_sequence<k...>);

  struct Trial {
    JointVector q;
    Kinematics<Space, N, Scalar> kinematics;
    decltype(errors_of(std::make_index_sequence<Stack_::kLevels>{})) errors;  ///< Errors of each level, in metres.
    NearGaps<N, Scalar> gaps;
    /// Σ e² of the tasks of each level that must reach their targets, and the cost of the gaps [m²].
    std::array<Scalar, std::size_t{Stack_::kLevels}> costs;
    std::array<bool, std::size_t{Stack_::kLevels}> must;  ///< Whether a level has tasks that must reach their targets.
    Scalar cost;                                          ///< Σ costs [m²]
    Scalar rest;                                          ///< Σ e² of the other tasks [m²].
  };

  StackSearch(const Arm& arm, Scalar length, Bounds_& bounds, const JointVector& lower, const JointVector& upper,
              const Point& target, Scalar tolerance) noexcept
      : arm_(arm), bounds_(bounds), lower_(lower), upper_(upper), target_(target), length_(length) {
    const Scalar largest = tolerance * std::min(Scalar(1), length);
    enough_ = largest * largest;
    gap_weight_ = NearGaps<N, Scalar>::weight(largest);
  }

  /// Characteristic length [m].
  [[nodiscard]] Scalar length() const noexcept { return length_; }

  void evaluate(Trial& trial) const noexcept {
    arm_.kinematics(trial.q, trial.kinematics);
    const Vector<Space::kRows, Scalar> error = task_error(trial.kinematics, target_);
    trial.gaps.set(bounds_, trial.q, gap_weight_);
    trial.costs.fill(Scalar(0));
    trial.must.fill(false);
    trial.costs[0] = trial.gaps.cost;
    trial.rest = Scalar(0);
    std::array<Eigen::Index, std::size_t{Stack_::kLevels}> rows{};
    Space::each([&](auto space, auto i, int row) noexcept {
      constexpr auto kTask = decltype(i)::value;
      constexpr auto kLevel = static_cast<std::size_t>(Stack_::level(static_cast<int>(kTask)));
      using Task = std::tuple_element_t<kTask, typename Stack_::Tasks>;
      const auto& S = std::get<kTask>(trial.kinematics.tasks).S;
      if (!trial.kinematics.enabled[kLevel] || S.rows() == 0) return;
      const Vector<decltype(space)::kRows, Scalar> own = error.template segment<decltype(space)::kRows>(row);
      auto& errors = std::get<kLevel>(trial.errors);
      constexpr bool kMust = kLevel == 0 || !kIsPosture<Task>;
      if (kMust) trial.must[kLevel] = true;
      Scalar& cost = kMust ? trial.costs[kLevel] : trial.rest;
      if (rows[kLevel] == 0) errors.resize(std::get<kLevel>(trial.kinematics.levels).rows());
      for (Eigen::Index j = 0; j < S.rows(); ++j) {
        Scalar e(0);
        if constexpr (Task::kWhole) {
          e = S.coeff(j, j) * own.coeff(j);
        } else {
          e = sum_over(own, [&](Eigen::Index c) { return S.coeff(j, c) * own.coeff(c); });
        }
        errors.coeffRef(rows[kLevel]++) = e;
        cost += e * e;
      }
    });
    trial.cost = Scalar(0);
    for (const Scalar cost : trial.costs) trial.cost += cost;
  }
  [[nodiscard]] Scalar cost(const JointVector& q) const noexcept {
    Trial trial;
    trial.q = q;
    evaluate(trial);
    return trial.cost;
  }
  [[nodiscard]] bool reached(const Trial& trial) const noexcept {
    return std::all_of(trial.costs.begin(), trial.costs.end(), [&](Scalar cost) { return cost <= enough_; });
  }

  /// Largest distance [m] or angle [rad] from a target that must be reached.
  [[nodiscard]] static Scalar largest_error(const Kinematics<Space, N, Scalar>& kinematics,
                                            const Point& target) noexcept {
    const Vector<Space::kRows, Scalar> error = task_error(kinematics, target);
    Scalar largest(0);
    Space::each([&](auto space, auto i, int row) noexcept {
      using Part = decltype(space);
      constexpr auto kTask = decltype(i)::value;
      constexpr auto kLevel = static_cast<std::size_t>(Stack_::level(static_cast<int>(kTask)));
      if (kLevel > 0 && kIsPosture<std::tuple_element_t<kTask, typename Stack_::Tasks>>) return;
      if (!kinematics.enabled[kLevel] || std::get<kTask>(kinematics.tasks).S.rows() == 0) return;
      largest = std::max(largest, larger_part<Part, Scalar>(error.template segment<Part::kRows>(row)));
    });
    return largest;
  }

  /// Whether the trial is better than `now`: has a smaller cost on the first level whose costs differ. Costs within the
  /// tolerance are equal.
  [[nodiscard]] bool better(const Trial& trial, const Trial& now) const noexcept {
    for (std::size_t k = 0; k < trial.costs.size(); ++k) {
      const Scalar was = std::max(now.costs[k], enough_);
      const Scalar is = std::max(trial.costs[k], enough_);
      if (is != was) return is < was;
    }
    return trial.rest < now.rest;
  }
  static void take(bool better, const Trial& trial, Trial& now) noexcept {
    if (better) now = trial;
  }

  /// Posture after a step from `now`, level by level in the null spaces of the levels above:
  ///
  ///   Δq ← Δq + Z w,   w = Aᵀ(A Aᵀ + λ c I)⁻¹ (e − J Δq),   A = J Z,
  ///
  /// where c is the cost of the level. The gaps are rows of the first level. A joint on an end of its range that would
  /// move outward is held: its columns are zero.
  [[nodiscard]] JointVector step(const Trial& now, Scalar lambda) const noexcept { return step(now, lambda, true); }
  /// Posture after a step, without damping, for the targets that must be reached.
  [[nodiscard]] JointVector correction(const Trial& now) const noexcept { return step(now, Scalar(0), false); }

 private:
  static constexpr Scalar kLongest = Scalar(1.3);    ///< As TipSearch::kLongest.
  static constexpr Scalar kRegular = Scalar(1e-12);  ///< As TipSearch::kRegular.

  [[nodiscard]] JointVector step(const Trial& now, Scalar lambda, bool all) const noexcept {
    JointBits held = 0;
    JointVector step;
    for (Eigen::Index i = 0; i <= now.q.size(); ++i) {
      step = resolve(now, lambda, held, all);
      const JointBits outward = outward_joints(now.q, step) & ~held;
      if (outward == 0) break;
      held |= outward;
    }
    const Scalar fraction = kLongest / std::max(kLongest, largest_magnitude(step));
    return entrywise(step, [&](Eigen::Index i) {
      return std::min(std::max(now.q.coeff(i) + fraction * step.coeff(i), lower_.coeff(i)), upper_.coeff(i));
    });
  }

  [[nodiscard]] JointBits outward_joints(const JointVector& q, const JointVector& step) const noexcept {
    JointBits joints = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const bool outward = (q.coeff(i) >= upper_.coeff(i) && step.coeff(i) > Scalar(0)) ||
                           (q.coeff(i) <= lower_.coeff(i) && step.coeff(i) < Scalar(0));
      if (outward) joints |= joint_bit(i);
    }
    return joints;
  }

  [[nodiscard]] JointVector resolve(const Trial& now, Scalar lambda, JointBits held, bool all) const noexcept {
    LevelStep<N, Scalar> step(now.q.size(), held);
    each(Constant<0>{}, Constant<Stack_::kLevels>{}, [&](auto level) noexcept {
      constexpr auto kLevel = static_cast<std::size_t>(decltype(level)::kIndex);
      const auto& rows = std::get<kLevel>(now.kinematics.levels);
      const auto& e = std::get<kLevel>(now.errors);
      if ((kLevel > 0 && !now.kinematics.enabled[kLevel]) || rows.rows() == 0 || !(all || now.must[kLevel])) return;
      const Scalar cost = squared_norm(e) + (kLevel == 0 ? now.gaps.cost : Scalar(0));
      const Scalar damping = lambda * cost + kRegular * length_ * length_;
      kLevel == 0 && now.gaps.count > 0 ? step.add(rows, e, now.gaps, damping) : step.add(rows, e, damping);
    });
    return step.value();
  }

  const Arm& arm_;
  Bounds_& bounds_;
  JointVector lower_;
  JointVector upper_;
  Point target_;
  Scalar length_;
  Scalar enough_;      ///< Largest cost at a target [m²].
  Scalar gap_weight_;  ///< NearGaps::weight().
};

}  // namespace fpbm
