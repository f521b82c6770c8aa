#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fpbm/bound/detail/torque_deviation.hpp"
#include "fpbm/bound/detail/torque_models.hpp"
#include "fpbm/bound/detail/torque_state.hpp"
#include "fpbm/limits/detail/stop.hpp"
#include "fpbm/limits/detail/stop_advance.hpp"

namespace fpbm {

/// Checks whether the torques keep their bounds at the start and at the end of each tick of a stopping trajectory
/// (docs/torques_proof.md).
///
/// The trajectory is checked in parts of as many ticks as TorqueDeviation allows, from the start on. The torques at the
/// ends of the parts are evaluated, or taken from the stop of the tick before if both states are so near that
/// TorqueDeviation proves the bounds.
template <int N, typename Scalar = double, int Joints = N>
class TorqueCertificate {
 public:
  using JointVector = Vector<N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;
  using Models = TorqueModels<Model>;
  using MotionLimits = Limits<Level::kAcceleration, N, Scalar>;
  using StopOf = Stop<Level::kAcceleration, N, Scalar>;

  template <typename Source>
  TorqueCertificate(const Source& source, const Models& models)
      : deviation_(source, models.back()),
        braking_(models[0].dof(), models.size()),
        tick_{braking_, braking_},
        ends_{braking_, braking_, braking_, braking_, braking_, braking_,
              braking_, braking_, braking_, braking_, braking_, braking_},
        none_(filled<JointVector>(models[0].dof())) {}

  /// Starts a tick, which may spend kLargestCost. Returns the torques in a state, which remain valid in the
  /// tick.
  const TorqueState<N, Scalar>& begin(const Models& models, const State<N, Scalar>& state) noexcept {
    cost_ = 0;
    if (!next().is_at(state)) return evaluated(here(), models, state);
    here_ = 1 - here_;
    return here();
  }
  /// The torques at the predicted end of the tick. keeps() may change the result.
  const TorqueState<N, Scalar>& ahead(const Models& models, const State<N, Scalar>& state) noexcept {
    return evaluated(next(), models, state);
  }

  /// Whether |τ| ≤ most in the tick from a state and in the stop after the tick.
  [[nodiscard]] bool keeps(const Models& models, const JointVector& most, const MotionLimits& limits,
                           const State<N, Scalar>& from, const StopOf& stop) noexcept {
    kept_fraction_ = Scalar(0);
    if ((cost_ += kStop) > kLargestCost) return false;
    StopPart<N, Scalar> part(stop.start, stop.plan.last());
    if (!evaluated(here(), models, from).keeps(most, part.last)) return false;
    if (!evaluated(next(), models, part.state).keeps(most, part.last)) return false;
    auto plan = stop.plan;
    likely_ = first_;
    bool checked = false;
    TorqueState<N, Scalar>* start = &next();
    for (std::size_t k = 0; plan.ticks_left() > Scalar(0); k = k + 1 < kEnds ? k + 1 : k - 1) {
      if (!keeps_part(models, most, limits, stop, *start, plan, part, k, checked)) return false;
      start = &ends_[k];
    }
    return start != &next() || next().keeps(most, none_);  // If the tick ends at rest.
  }

  /// After keeps() was false: fraction of the decelerations with which the bounds are kept where they were exceeded. 0
  /// if there is none, or for another reason.
  [[nodiscard]] Scalar kept_fraction() const noexcept { return kept_fraction_; }

 private:
  TorqueState<N, Scalar>& here() noexcept { return tick_[here_]; }
  TorqueState<N, Scalar>& next() noexcept { return tick_[1 - here_]; }

  /// Stops have as many parts at most, as a rule.
  static constexpr std::size_t kEnds = 12;
  /// Costs of an evaluation, of a stop, and of a tick of a joint that stops alone. A part has the cost 1: for a Panda,
  /// about 2,500 instructions, and 182 for a tick of a joint that stops alone.
  static constexpr int kEvaluation = 2;
  static constexpr int kStop = 2;
  static constexpr Scalar kTickAlone = Scalar(0.125);
  /// Largest cost of a tick: a compromise. Of 60,000 ticks of a Panda with 3 kg at 80 % of its efforts, 4,152 continue
  /// the stop with 42, 2,937 with 63, and 2,608 with 84. With 42, KeptPath.is_kept_at_the_edge_of_the_torques fails.
  static constexpr int kLargestCost = 63;

  /// Whether |τ| ≤ most at the end of the full deceleration, and with no acceleration there: most stops that exceed a
  /// bound exceed the bound there.
  [[nodiscard]] bool may_keep(const Models& models, const JointVector& most, const MotionLimits& limits,
                              const StopOf& stop) noexcept {
    auto plan = stop.plan;
    StopPart<N, Scalar> part(stop.start, plan.last());
    const Scalar ticks = plan.braking_ticks();
    if (!(ticks > Scalar(0))) return true;
    advance(plan, limits, ticks, part);
    cost_ += static_cast<int>(part.ticks_alone * kTickAlone);
    if (!braking_.is_at(part.state)) {
      const JointVector more = deviation_.between(braking_.of[models.size() - 1].M, braking_.at, part.state, part);
      if (braking_.kept_part(most, part, more, true) >= Scalar(1)) return true;
      if (!braking_.exceeds(most, part.last, more)) evaluated(braking_, models, part.state);
    }
    if (!braking_.keeps(most, part.last)) kept_fraction_ = braking_.kept_fraction(most, part.last);
    // A slower stop ends farther away.
    return kept_fraction_ == Scalar(0) && braking_.keeps(most, none_);
  }

  /// Advances a plan and a part of the stop by as many ticks as are proved to keep the bounds. Returns whether any are.
  /// start: torques near the start of the part. k: index of the part. checked: whether may_keep() was true.
  [[nodiscard]] bool keeps_part(const Models& models, const JointVector& most, const MotionLimits& limits,
                                const StopOf& stop, TorqueState<N, Scalar>& start,
                                StopPlan<Level::kAcceleration, N, Scalar>& plan, StopPart<N, Scalar>& part,
                                std::size_t k, bool& checked) noexcept {
    const auto from = part.state;
    const auto last = part.last;
    for (Scalar ticks = std::min(plan.ticks_left(), likely_); cost_ < kLargestCost;) {
      ++cost_;
      auto next = plan;
      advance(next, limits, ticks, part);
      cost_ += static_cast<int>(part.ticks_alone * kTickAlone);
      const bool single = !(ticks > Scalar(1));
      const bool rests = !(next.ticks_left() > Scalar(0));
      const JointVector deviation = single ? none_
                                           : deviation_.of(start.of[models.size() - 1].M, start.at.q, from.q, part,
                                                           plan.velocity(), ticks * limits.tick());
      Scalar part_kept = kept(models, most, start, from, part, deviation, false);
      if (part_kept >= Scalar(1)) {
        part_kept = std::min(part_kept, kept(models, most, ends_[k], part.state, part, deviation, rests));
      }
      // The deviation increases with the square of the duration, approximately.
      const Scalar root = std::sqrt(std::max(part_kept, Scalar(0)));
      if (part_kept >= Scalar(1)) {
        likely_ = rests ? std::numeric_limits<Scalar>::infinity()
                        : std::ceil(ticks * std::max(Scalar(0.85) * root, Scalar(1)));
        if (k == 0) first_ = likely_;
        plan = next;
        return true;
      }
      if (ends_[k].is_at(part.state) && !(ends_[k].keeps(most, part.last) && (!rests || ends_[k].keeps(most, none_)))) {
        kept_fraction_ = ends_[k].kept_fraction(most, part.last);
        return false;
      }
      if (single || part_kept < Scalar(-1)) {
        // The accelerations of the ramp do not depend on the fraction of the deceleration.
        const bool slower = !plan.ramps() || start.keeps(most, part.corners[0]);
        if (slower) kept_fraction_ = start.kept_fraction(most, part.corners[part.corner_count - 1]);
        return false;
      }
      if (!checked && !may_keep(models, most, limits, stop)) return false;
      checked = true;
      // The factors 0.9 and 0.85 leave a margin for the next attempt: choices.
      ticks = std::max(std::floor(ticks * std::clamp(Scalar(0.9) * root, Scalar(0.2), Scalar(0.9))), Scalar(1));
      part.state = from;
      part.last = last;
    }
    return false;
  }

  /// Largest fraction of `deviation` with which the torques in the state `at` keep the bounds for the accelerations of
  /// a part, at rest too if the part ends at rest. torques: of a state near `at`, or replaced by the torques in this
  /// state.
  [[nodiscard]] Scalar kept(const Models& models, const JointVector& most, TorqueState<N, Scalar>& torques,
                            const State<N, Scalar>& at, const StopPart<N, Scalar>& part, const JointVector& deviation,
                            bool rests) noexcept {
    if (torques.is_at(at)) return torques.kept_part(most, part, deviation, rests);
    JointVector least = deviation_.between(torques.of[models.size() - 1].M, torques.at, at, part);
    for (Eigen::Index i = 0; i < least.size(); ++i) least.coeffRef(i) = most.coeff(i) - least.coeff(i);
    const Scalar near = torques.kept_part(least, part, deviation, rests);
    if (near >= Scalar(1)) return near;
    return evaluated(torques, models, at).kept_part(most, part, deviation, rests);
  }

  const TorqueState<N, Scalar>& evaluated(TorqueState<N, Scalar>& torques, const Models& models,
                                          const State<N, Scalar>& state) noexcept {
    if (torques.set(models, state, memory_)) cost_ += kEvaluation;
    return torques;
  }

  TorqueDeviation<N, Scalar, Joints> deviation_;
  TorqueState<N, Scalar> braking_;                          ///< At the end of the full deceleration.
  std::array<TorqueState<N, Scalar>, 2> tick_;              ///< At the start and at the end of the tick, alternately.
  std::array<TorqueState<N, Scalar>, kEnds> ends_;          ///< Near the ends of the parts of the stop.
  Scalar first_ = std::numeric_limits<Scalar>::infinity();  ///< Likely length of the first part of a stop [ticks].
  JointVector none_;
  typename Model::State memory_;
  Scalar likely_ = Scalar(1);  ///< Likely length of the next part [ticks].
  std::size_t here_ = 0;
  int cost_ = 0;
  Scalar kept_fraction_ = Scalar(0);
};

}  // namespace fpbm
