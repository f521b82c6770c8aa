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

  [[nodiscard]] bool runs_in_lanes() const noexcept {
    return scheme->is_plain() && !std::holds_alternative<Scheme::Dense>(scheme->weights) && output.buffers.t == nullptr;
  }
};

[[nodiscard]] inline bool runs_in_lanes(const Arm& arm) noexcept {
  if (const auto* chain = std::get_if<Chain<>>(&arm.source)) {
    return arm.dof() == 7 && chain->joints.size() == 7;  // No joint is a mimic joint.
  }
  return arm.dof() == 4;
}

/// Motions on one arm along one path, as simulate() or, with limits, as track().
template <typename Space>
struct Sweep {
  const Arm& arm;
  const AnyPath<Space>& path;
  const TimeGrid<double>& grid;
  const LimitOptions* limits;  ///< Null without limits.
  const StackOptions* stack;   ///< Null without a stack.
  const std::atomic<bool>& stop;

  /// Runs each job, and writes an outcome for each job. If code is not null, motions of one task run side by side; the
  /// result of a motion does not depend on the motions in the other lanes. stop is read in every sample; if stop is
  /// set, unfinished motions are marked as not run. Throws std::invalid_argument if a scheme, a start or the limits do
  /// not fit the arm.
  void run(const std::vector<Job<Space>>& jobs, const LaneCode* code, Outcome* outcomes) const {
    std::fill_n(outcomes, jobs.size(), Outcome::of_nothing());
    if constexpr (!std::is_same_v<Space, PlanarPose>) {
      if (code != nullptr && runs_in_lanes(arm) && stack == nullptr) {
        for (const Level level : {Level::kVelocity, Level::kAcceleration}) run_in_lanes(jobs, level, *code, outcomes);
      }
    }
    for (std::size_t i = 0; i < jobs.size() && !stopped(); ++i) {
      if (outcomes[i].status == Outcome::kNotRun) outcomes[i] = alone(jobs[i]);
    }
  }

 private:
  static constexpr int kDof = ArmInLanes<Space>::kDof;

  [[nodiscard]] bool stopped() const noexcept { return stop.load(std::memory_order_relaxed); }
  [[nodiscard]] Motion<Space> motion(const Job<Space>& job) const {
    return {&std::get<AnyArmFor<Space>>(arm.any),       path, *job.scheme,
            {job.q0, JointVector::Zero(job.q0.size())}, grid, stack};
  }

  /// Runs one motion without lanes.
  [[nodiscard]] Outcome alone(const Job<Space>& job) const {
    const Outcome nothing = Outcome::of_nothing();
    MotionSummary<> summary = nothing.summary;
    Output<Space> output = job.output;
    output.summary = &summary;
    output.stop = &stop;
    const Motion<Space> one = motion(job);
    const auto result = limits == nullptr ? one.simulate(output) : one.track(*limits, output);
    if (!failed(result.status) && result.samples < grid.samples()) return nothing;
    if (result.samples == 0) summary = nothing.summary;
    return {static_cast<int>(result.status), result.samples, result.time, summary};
  }

  /// Runs the jobs that have schemes of a level and can run side by side, in groups with one job per lane. The last job
  /// fills the free lanes of the last group.
  void run_in_lanes(const std::vector<Job<Space>>& jobs, Level level, const LaneCode& code, Outcome* outcomes) const {
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (jobs[i].scheme->level == level && jobs[i].runs_in_lanes()) members.push_back(i);
    }
    using Source = std::conditional_t<std::is_same_v<Space, Position<2>>, JointVector, Chain<>>;
    const ArmInLanes<Space> own(std::get<Source>(arm.source));
    const auto lanes = static_cast<std::size_t>(code.lanes);
    std::vector<Outcome> results(lanes, Outcome::of_nothing());
    for (std::size_t first = 0; first < members.size() && !stopped(); first += lanes) {
      const std::size_t last = std::min(first + lanes, members.size());
      SchemesInLanes<Space> schemes;
      std::vector<Vector<kDof>> starts;
      TrackersInLanes<Space> trackers;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const Job<Space>& job = jobs[members[std::min(first + lane, last - 1)]];
        const auto damped = [&](auto law) {  // With the damping of the tracker.
          if (limits != nullptr) set_damping(law, limits->options.damping(kDof, Space::kRows));
          return law;
        };
        const DiagonalWeights<kDof> weights = job.scheme->template diagonal_weights<kDof>(kDof);
        if (level == Level::kVelocity) {
          schemes.velocity.push_back(damped(job.scheme->template law<Level::kVelocity>(weights, own.limits())));
        } else {
          schemes.acceleration.push_back(damped(job.scheme->template law<Level::kAcceleration>(weights, own.limits())));
        }
        starts.emplace_back(job.q0);
        if (limits != nullptr) trackers.push_back(motion(job).template tracker<kDof>(*limits));
      }
      std::get<RunInLanes<Space>>(code.run)(own, path, grid, schemes, starts, std::move(trackers), stop,
                                            results.data());
      for (std::size_t i = first; i < last; ++i) outcomes[members[i]] = results[i - first];
    }
  }
};

}  // namespace fpbm::bindings
