#pragma once

#include <benchmark/benchmark.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "jobs.hpp"

// Rows of bench_limited: unlimited/arm/task/bounds/library for kinematics and scheme alone, and limited/… for
// kinematics and scheme within the joint limits. A solver is one library for one case: move() computes tip, J, Jd and
// the desired motion of the scheme, limit() the motion within the limits. Each file of a library adds its own solver.
namespace bench {

enum class Bounds { kAcceleration, kJerk };

template <Bounds bounds>
using BoundsConstant = std::integral_constant<Bounds, bounds>;

constexpr double kTick = 1e-3;

/// Limits of the arm of a case: on position, velocity and acceleration, and on jerk if required.
template <typename Case>
fpbm::Limits<fpbm::Level::kAcceleration, Case::kDof> limits(Bounds bounds) {
  auto joints = Case::Robot::arm().limits();
  if (bounds == Bounds::kAcceleration) joints.jerk.setConstant(fpbm::JointBounds<>::kNone);
  return {joints, kTick};
}

template <typename Case>
struct Asked : Input<typename Case::Space, Case::kDof> {
  fpbm::Vector<Case::kDof> last;  ///< Acceleration of the last tick.
};

template <typename Case>
struct Answer {
  fpbm::Vector<Case::kDof> u;
  double scale;  ///< Task scale.
};

/// Calls solve(box, from, desired, answer) for each problem of Limiter: the motion from `from` toward `desired`, as far
/// as the box admits. Without bounds on jerk, there is one problem: `from` is a motion that slows the arm down. With
/// bounds on jerk, there are two problems. The first problem is this problem in box_in_time(). In the second problem,
/// `from` is the acceleration of the last tick, `desired` is the result of the first problem, and the box is the box of
/// the tick. Returns false if solve() finds no solution.
template <typename Case, int N = Case::kDof, typename Solve>
bool solve_within(const fpbm::Limits<fpbm::Level::kAcceleration, N>& limits, const Asked<Case>& asked,
                  const fpbm::Vector<N>& desired, Answer<Case>& answer, Solve&& solve) {
  const auto& state = asked.state;
  const fpbm::Box<N> box = limits.box(state, asked.last);
  if (!limits.bounds_jerk()) return solve(box, brake_in_proportion(limits, state, box), desired, answer);
  answer = {desired, 1.0};
  const fpbm::Box<N> in_time = box_in_time(limits, state, asked.last, box);
  if (!in_time.contains(desired)) {
    if (!solve(in_time, brake_in_proportion(limits, state, in_time), desired, answer)) return false;
  }
  if (box.contains(answer.u)) return true;
  const Answer<Case> goal = answer;
  if (!solve(box, box.nearest(asked.last), goal.u, answer)) return false;
  answer.scale *= goal.scale;
  return true;
}

/// A limited step of this library.
template <typename Case_, Bounds bounds>
class OursLimited {
 public:
  using Case = Case_;
  static constexpr const char* kLibrary = "fpbm_cpp";

  void move(const Asked<Case>& asked) {
    arm_.kinematics(asked.state.q, asked.state.qd, kinematics_);
    status_ = scheme_.resolve(kinematics_, asked.reference, asked.state, desired_);
  }
  bool limit(const Asked<Case>& asked, Answer<Case>& answer) const {
    const auto found = limiter_.motion(kinematics_.J, asked.state, desired_, asked.last);
    answer = {found.u, found.scale};
    return true;
  }

  [[nodiscard]] const auto& J() const { return kinematics_.J; }
  [[nodiscard]] const fpbm::Vector<Case::kDof>& desired() const { return desired_; }
  [[nodiscard]] const auto& limiter() const { return limiter_; }

 private:
  static constexpr int N = Case::kDof;
  typename Case::Robot::Arm arm_ = Case::Robot::arm();
  decltype(scheme<Law::kFPBM, N>()) scheme_ = scheme<Law::kFPBM, N>();
  fpbm::Limiter<fpbm::Level::kAcceleration, N> limiter_{limits<Case>(bounds)};
  fpbm::Kinematics<typename Case::Space, N> kinematics_;
  fpbm::Vector<N> desired_;
  fpbm::Status status_;
};

/// Random viable states, with references that exceed the limits. The states are the same in every run.
template <typename Case, Bounds bounds>
std::vector<Asked<Case>> asked(std::size_t count) {
  constexpr int N = Case::kDof;
  const auto limits = bench::limits<Case>(bounds);
  const fpbm::JointLimits<N>& joints = limits.bounds();
  OursLimited<Case, bounds> ours;
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto fill = [&](auto vector, double reach) {
    for (double& value : vector) value = reach * uniform(generator);
    return vector;
  };
  const fpbm::Vector<Case::kRows> zero = fpbm::Vector<Case::kRows>::Zero();
  std::vector<Asked<Case>> result;
  while (result.size() < count) {
    Asked<Case> one;
    const fpbm::Vector<N> part = fill(joints.lower, 1.0);
    one.state.q = (joints.upper + joints.lower + part.cwiseProduct(joints.upper - joints.lower)) / 2.0;
    one.state.qd = joints.velocity.cwiseProduct(fill(joints.lower, 0.3));
    one.last.setZero();
    if (bounds == Bounds::kJerk) one.last = joints.acceleration.cwiseProduct(fill(joints.lower, 0.3));
    try {
      limits.require_viable(one.state, one.last);
    } catch (const std::invalid_argument&) {
      continue;
    }
    fpbm::Kinematics<typename Case::Space, N> kinematics;
    Case::Robot::arm().kinematics(one.state.q, kinematics);
    one.reference.x = Case::Space::template displace<double>(kinematics.tip, fill(zero, 0.1));
    one.reference.xd = fill(zero, 0.5);
    one.reference.xdd = fill(zero, 0.5);
    ours.move(one);
    if (!limits.box(one.state, one.last).contains(ours.desired())) result.push_back(one);
  }
  return result;
}

/// Results of a library on 10,000 problems, compared with this library.
struct Score {
  int slowed = 0;    ///< This library scales the task: with the whole task as an equality, the problem has no solution.
  int unsolved = 0;  ///< The library finds no solution.
  int off_line = 0;  ///< The tip leaves the line of the task by more than 1e-3 rad.
  int outside = 0;   ///< A joint exceeds its box by more than 1e-6 of its bound.
  int smaller = 0;   ///< The task scale is smaller by more than 1 %.
  int larger = 0;    ///< The task scale is larger by more than 1 %.
};

/// The line of the task in the last problem of a step, and the task scale of this library's saturation.
template <typename Case>
struct Line {
  fpbm::Vector<Case::kDof> from;
  fpbm::Vector<Case::kRows> task;
  double scale;
};

template <typename Case, typename Ours>
Line<Case> line(const Ours& ours, const Asked<Case>& asked) {
  constexpr int N = Case::kDof;
  const auto& limits = ours.limiter().limits();
  fpbm::NullSpaceSaturation<Case::kRows, N, double> saturation(ours.J(), limits.bounds().acceleration);
  Line<Case> line;
  Answer<Case> answer;
  const auto saturate = [&](const auto& box, const auto& from, const auto& desired, Answer<Case>& found) {
    const auto saturated = saturation(box, from, desired);
    found = {saturated.u, saturated.scale};
    line = {from, ours.J() * (desired - from), found.scale};
    return true;
  };
  solve_within(limits, asked, ours.desired(), answer, saturate);
  return line;
}

template <typename Solver, Bounds bounds>
Score score() {
  using Case = typename Solver::Case;
  Score score;
  Solver solver;
  OursLimited<Case, bounds> ours;
  for (const Asked<Case>& one : asked<Case, bounds>(10000)) {
    Answer<Case> expected;
    Answer<Case> found;
    ours.move(one);
    ours.limit(one, expected);
    score.slowed += expected.scale < 1.0 ? 1 : 0;
    solver.move(one);
    if (!solver.limit(one, found)) {
      ++score.unsolved;
      continue;
    }
    const auto& limits = ours.limiter().limits();
    const auto box = limits.box(one.state, one.last);
    const auto [from, task, scale] = line(ours, one);
    const fpbm::Vector<Case::kRows> done = ours.J() * (found.u - from);
    const double along = done.dot(task) / task.squaredNorm();
    score.off_line += (done - along * task).norm() > 1e-3 * done.norm() && done.norm() > 1e-6 * task.norm() ? 1 : 0;
    const fpbm::Vector<Case::kDof> beyond =
        (found.u - box.nearest(found.u)).cwiseQuotient(limits.bounds().acceleration);
    score.outside += beyond.cwiseAbs().maxCoeff() > 1e-6 ? 1 : 0;
    score.smaller += along < 0.99 * scale ? 1 : 0;
    score.larger += along > 1.01 * scale ? 1 : 0;
  }
  return score;
}

/// Steps of a solver, with or without limits.
template <typename Solver, Bounds bounds, bool kLimits>
void limited_steps(benchmark::State& bench) {
  using Case = typename Solver::Case;
  const auto ring = asked<Case, bounds>(1000);
  Solver solver;
  Answer<Case> answer;
  std::size_t turn = 0;
  for (auto _ : bench) {
    const auto& one = ring[++turn % ring.size()];
    solver.move(one);
    if constexpr (kLimits) benchmark::DoNotOptimize(solver.limit(one, answer));
    escape(solver);
    escape(answer);
  }
}

template <typename Solver, Bounds bounds>
void add_limited() {
  const std::string row =
      Solver::Case::name() + (bounds == Bounds::kJerk ? "/jerk/" : "/acceleration/") + Solver::kLibrary;
  benchmark::RegisterBenchmark(("unlimited/" + row).c_str(), limited_steps<Solver, bounds, false>);
  benchmark::RegisterBenchmark(("limited/" + row).c_str(), [](benchmark::State& bench) {
    limited_steps<Solver, bounds, true>(bench);
    static const Score kScore = score<Solver, bounds>();
    bench.counters["slowed"] = kScore.slowed;
    bench.counters["unsolved"] = kScore.unsolved;
    bench.counters["off_line"] = kScore.off_line;
    bench.counters["outside"] = kScore.outside;
    bench.counters["smaller"] = kScore.smaller;
    bench.counters["larger"] = kScore.larger;
  });
}

/// Every case with both types of bounds.
template <template <typename, Bounds> class Solver>
bool add_limited_library() {
  const auto add = [](auto arm_and_task, auto bounds) {
    add_limited<Solver<decltype(arm_and_task), bounds()>, bounds()>();
  };
  add(PandaPose{}, BoundsConstant<Bounds::kAcceleration>{});
  add(PandaPose{}, BoundsConstant<Bounds::kJerk>{});
  add(Case<Panda, fpbm::Position<3>>{}, BoundsConstant<Bounds::kAcceleration>{});
  add(Case<Panda, fpbm::Position<3>>{}, BoundsConstant<Bounds::kJerk>{});
  return true;
}

}  // namespace bench
