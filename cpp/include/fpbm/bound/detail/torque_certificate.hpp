#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "fpbm/bound/detail/torque_deviation.hpp"
#include "fpbm/bound/detail/torque_state.hpp"
#include "fpbm/limits/detail/stop.hpp"
#include "fpbm/limits/detail/stop_advance.hpp"

namespace fpbm {

/// Checks whether the torques keep their bounds at the start and at the end of each tick of a stopping trajectory
/// (docs/torques_proof.md).
///
/// The trajectory is checked in parts of as many ticks as TorqueDeviation allows, from the start on. Torques are
/// evaluated at the ends of the parts.
template <int N, typename Scalar = double, int Joints = N>
class TorqueCertificate {
 public:
  using JointVector = Vector<N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;
  using Models = std::vector<Model>;
  using MotionLimits = Limits<Level::kAcceleration, N, Scalar>;
  using StopOf = Stop<Level::kAcceleration, N, Scalar>;

  template <typename Source>
  TorqueCertificate(const Source& source, const Models& models)
      : deviation_(source, models.back()),
        here_(models[0].dof(), models.size()),
        next_(here_),
        ends_{here_, here_},
        none_(filled<JointVector>(models[0].dof())) {}

  /// Starts a tick, which may evaluate kEvaluations states. Returns the torques in a state, which remain valid in the
  /// tick.
  const TorqueState<N, Scalar>& begin(const Models& models, const State<N, Scalar>& state) noexcept {
    evaluations_ = 0;
    if (next_.is_at(state)) std::swap(here_, next_);
    return evaluated(here_, models, state);
  }
  /// The torques at the predicted end of the tick. keeps() may change the result.
  const TorqueState<N, Scalar>& ahead(const Models& models, const State<N, Scalar>& state) noexcept {
    return evaluated(next_, models, state);
  }

  /// Whether |τ| ≤ most in the tick from a state and in the stop after the tick.
  [[nodiscard]] bool keeps(const Models& models, const JointVector& most, const MotionLimits& limits,
                           const State<N, Scalar>& from, const StopOf& stop) noexcept {
    kept_fraction_ = Scalar(0);
    if (evaluations_ > kEvaluations) return false;
    StopPart<N, Scalar> part{stop.start, stop.plan.last(), none_, none_, none_};
    if (!is_finite(part.state.q) || !is_finite(part.state.qd)) return false;
    if (!evaluated(here_, models, from).keeps(most, part.last)) return false;
    if (!evaluated(next_, models, part.state).keeps(most, part.last)) return false;
    auto plan = stop.plan;
    const TorqueState<N, Scalar>* start = &next_;
    for (std::size_t end = 0; plan.ticks_left() > Scalar(0); end = 1 - end) {
      if (!keeps_part(models, most, limits, *start, plan, part, ends_[end])) return false;
      start = &ends_[end];
    }
    return start->keeps(most, none_);  // At rest.
  }

  /// After keeps() was false: fraction of the decelerations with which the bounds are kept where they were exceeded. 0
  /// if there is none, or for another reason.
  [[nodiscard]] Scalar kept_fraction() const noexcept { return kept_fraction_; }

 private:
  /// Most states that are evaluated in one tick: a compromise. Of 60,000 ticks of a Panda with 3 kg at 80 % of its
  /// efforts, 2,347 continue the stop with 24 evaluations, 1,630 with 48, and 1,348 with 96.
  static constexpr int kEvaluations = 40;

  /// Advances a plan and a part of the stop, from the torques `start` to the torques `end`, by as many ticks as are
  /// proved to keep the bounds. Returns whether any are.
  [[nodiscard]] bool keeps_part(const Models& models, const JointVector& most, const MotionLimits& limits,
                                const TorqueState<N, Scalar>& start, StopPlan<Level::kAcceleration, N, Scalar>& plan,
                                StopPart<N, Scalar>& part, TorqueState<N, Scalar>& end) noexcept {
    const auto before = part;
    for (Scalar ticks = plan.phase_ticks();;) {
      auto next = plan;
      part = before;
      advance(next, limits, ticks, part);
      const bool single = !(ticks > Scalar(1));
      const JointVector deviation =
          single ? none_ : deviation_.of(start.of[models.size() - 1].M, part, plan.velocity(), ticks * limits.tick());
      Scalar kept = start.kept_part(most, part.low, part.high, deviation);
      if (kept >= Scalar(1)) {
        if (!evaluated(end, models, part.state).keeps(most, part.last)) {
          kept_fraction_ = end.kept_fraction(most, part.last);
          return false;
        }
        if (evaluations_ > kEvaluations) return false;
        kept = end.kept_part(most, part.low, part.high, deviation);
        if (kept >= Scalar(1)) {
          plan = next;
          return true;
        }
      }
      if (single) {
        kept_fraction_ = start.kept_fraction(most, part.last);
        return false;
      }
      // The deviation increases with the square of the duration, approximately.
      const Scalar shorter = std::sqrt(std::max(kept, Scalar(0)));
      ticks = std::max(std::floor(ticks * std::clamp(shorter, Scalar(0.2), Scalar(0.8))), Scalar(1));
    }
  }

  const TorqueState<N, Scalar>& evaluated(TorqueState<N, Scalar>& torques, const Models& models,
                                          const State<N, Scalar>& state) noexcept {
    evaluations_ += torques.set(models, state, memory_) ? 1 : 0;
    return torques;
  }

  TorqueDeviation<N, Scalar, Joints> deviation_;
  TorqueState<N, Scalar> here_;     ///< At the start of the tick.
  TorqueState<N, Scalar> next_;     ///< At the end of the tick.
  TorqueState<N, Scalar> ends_[2];  ///< At the ends of the last two parts of the stop.
  JointVector none_;
  typename Model::State memory_;
  int evaluations_ = 0;
  Scalar kept_fraction_ = Scalar(0);
};

}  // namespace fpbm
