#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

#include "lanes.hpp"
#include "motion.hpp"

namespace fpbm::bindings {

/// One motion of a sweep: its scheme, its start at rest, and the arrays for the whole motion if it is recorded.
template <typename Space>
struct Job {
  const Scheme* scheme;
  JointVector q0;
  Output<Space> output = {};
};

/// Runs the motions of a sweep.
template <typename Space>
class Runner {
 public:
  Runner(const Arm& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid, const StackOptions* stack,
         const std::atomic<bool>& stop)
      : arm_(arm), any_(std::get<AnyArmFor<Space>>(arm.any)), path_(path), grid_(grid), stack_(stack), stop_(stop) {}

  [[nodiscard]] bool stopped() const noexcept { return stop_.load(std::memory_order_relaxed); }

  /// Runs one motion without lanes.
  [[nodiscard]] Outcome alone(const Job<Space>& job, const LimitOptions* limit_options) const {
    const Outcome nothing = Outcome::of_nothing();
    MotionSummary<> summary = nothing.summary;
    Output<Space> output = job.output;
    output.summary = &summary;
    output.stop = &stop_;
    const Motion<Space> one = motion(job);
    const auto result = limit_options == nullptr ? one.simulate(output) : one.track(*limit_options, output);
    if (!failed(result.status) && result.samples < grid_.samples()) return nothing;
    if (result.samples == 0) summary = nothing.summary;
    return {static_cast<int>(result.status), result.samples, result.time, summary};
  }

  /// Runs the jobs with the indices `members`, which have schemes of one level, in groups with one job per lane. The
  /// last job fills the free lanes of the last group.
  void in_lanes(const std::vector<Job<Space>>& jobs, const std::vector<std::size_t>& members,
                const LimitOptions* limit_options, std::size_t lanes, RunInLanes<Space> run, Outcome* outcomes) const {
    using Source = std::conditional_t<std::is_same_v<Space, Position<2>>, JointVector, Chain<>>;
    const ArmInLanes<Space> arm(std::get<Source>(arm_.source));
    std::vector<Outcome> results(lanes, Outcome::of_nothing());
    for (std::size_t first = 0; first < members.size() && !stopped(); first += lanes) {
      const std::size_t last = std::min(first + lanes, members.size());
      SchemesInLanes<Space> schemes;
      std::vector<Vector<kDof>> starts;
      TrackersInLanes<Space> trackers;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const Job<Space>& job = jobs[members[std::min(first + lane, last - 1)]];
        const Scheme& scheme = *job.scheme;
        const auto damped = [&](auto law) {  // With the damping of the tracker.
          if (limit_options != nullptr) set_damping(law, limit_options->options.damping(kDof, Space::kRows));
          return law;
        };
        const DiagonalWeights<kDof> weights = scheme.template diagonal_weights<kDof>(kDof);
        if (scheme.level == Level::kVelocity) {
          schemes.velocity.push_back(damped(scheme.template law<Level::kVelocity>(weights, arm.limits())));
        } else {
          schemes.acceleration.push_back(damped(scheme.template law<Level::kAcceleration>(weights, arm.limits())));
        }
        starts.emplace_back(job.q0);
        if (limit_options != nullptr) trackers.push_back(motion(job).template tracker<kDof>(*limit_options));
      }
      run(arm, path_, grid_, schemes, starts, std::move(trackers), stop_, results.data());
      for (std::size_t i = first; i < last; ++i) outcomes[members[i]] = results[i - first];
    }
  }

 private:
  static constexpr int kDof = ArmInLanes<Space>::kDof;

  [[nodiscard]] Motion<Space> motion(const Job<Space>& job) const {
    return {&any_, path_, *job.scheme, {job.q0, JointVector::Zero(job.q0.size())}, grid_, stack_};
  }

  const Arm& arm_;
  const AnyArmFor<Space>& any_;
  const AnyPath<Space>& path_;
  const TimeGrid<double>& grid_;
  const StackOptions* stack_;
  const std::atomic<bool>& stop_;
};

[[nodiscard]] inline bool runs_in_lanes(const Arm& arm) noexcept {
  if (const auto* chain = std::get_if<Chain<>>(&arm.source)) {
    return arm.dof() == 7 && chain->joints.size() == 7;  // No joint is a mimic joint.
  }
  return arm.dof() == 4;
}

[[nodiscard]] inline bool runs_in_lanes(const Scheme& scheme) noexcept {
  return scheme.is_plain() && !std::holds_alternative<Scheme::Dense>(scheme.weights);
}

/// The jobs of a level that can run side by side.
template <typename Space>
[[nodiscard]] std::vector<std::size_t> side_by_side(const std::vector<Job<Space>>& jobs, Level level) {
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const Job<Space>& job = jobs[i];
    if (job.scheme->level == level && runs_in_lanes(*job.scheme) && job.output.buffers.t == nullptr) {
      members.push_back(i);
    }
  }
  return members;
}

/// Runs each job on one arm along one path, as simulate() or, if limit_options is not null, as track(). Writes an
/// outcome for each job. If code is not null, motions of one task run side by side; the result of a motion does not
/// depend on the motions in the other lanes. stop is read in every sample; if stop is set, unfinished motions are
/// marked as not run. Throws std::invalid_argument if a scheme, a start or the limits do not fit the arm.
template <typename Space>
void sweep(const Arm& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
           const std::vector<Job<Space>>& jobs, const LimitOptions* limit_options, const StackOptions* stack,
           const LaneCode* code, const std::atomic<bool>& stop, Outcome* outcomes) {
  const Runner<Space> runner(arm, path, grid, stack, stop);
  std::fill_n(outcomes, jobs.size(), Outcome::of_nothing());
  if constexpr (!std::is_same_v<Space, PlanarPose>) {
    if (code != nullptr && runs_in_lanes(arm) && stack == nullptr) {
      for (const Level level : {Level::kVelocity, Level::kAcceleration}) {
        runner.in_lanes(jobs, side_by_side(jobs, level), limit_options, static_cast<std::size_t>(code->lanes),
                        std::get<RunInLanes<Space>>(code->run), outcomes);
      }
    }
  }
  for (std::size_t i = 0; i < jobs.size() && !runner.stopped(); ++i) {
    if (outcomes[i].status == Outcome::kNotRun) outcomes[i] = runner.alone(jobs[i], limit_options);
  }
}

}  // namespace fpbm::bindings
