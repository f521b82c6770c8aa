#pragma once

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "jobs.hpp"

// Rows of bench_step: part/arm/task/scheme/library. A solver is one library with one scheme for one case: move()
// computes tip, J and Jd of a state, resolve() the joint motion. Each file of a library adds its own solver.
namespace bench {

template <typename Job>
void run(benchmark::State& bench) {
  Job job;
  escape(job);
  for (auto _ : bench) job();
}

/// All solvers must do the same job: stops if a result differs from this library's by a relative error above 1e-9.
template <typename Solver>
void require_agreement(const std::string& row) {
  using Case = typename Solver::Case;
  Ours<Case, Solver::kLaw> ours;
  Solver solver;
  for (const auto& input : inputs(Case{})) {
    fpbm::Vector<Case::kDof> expected = fpbm::Vector<Case::kDof>::Zero();
    fpbm::Vector<Case::kDof> found = expected;
    ours.move(input);
    solver.move(input);
    const bool solved =
        ours.resolve(input, expected) == fpbm::Status::kOk && solver.resolve(input, found) == fpbm::Status::kOk;
    const double difference = (found - expected).norm() / expected.norm();
    if (!solved || !(difference <= 1e-9)) {
      std::fprintf(stderr, "%s: the result differs by %g\n", row.c_str(), difference);
      std::exit(EXIT_FAILURE);
    }
  }
}

template <typename Solver>
void add_step() {
  const std::string row = "step/" + Solver::Case::name() + "/" + name(Solver::kLaw) + "/" + Solver::kLibrary;
  require_agreement<Solver>(row);
  benchmark::RegisterBenchmark(row.c_str(), run<Step<Solver>>);
}

/// Every scheme for every case, and the kinematics of each level alone.
template <template <typename, Law> class Solver>
bool add_library() {
  for_each_case([](auto arm_and_task) {
    using Case = decltype(arm_and_task);
    for_each_law([](auto law) { add_step<Solver<Case, law()>>(); });
    const auto add_kinematics = [](const char* level, auto law) {
      using Chosen = Solver<Case, law()>;
      const std::string row = "kinematics/" + Case::name() + "/" + level + "/" + Chosen::kLibrary;
      benchmark::RegisterBenchmark(row.c_str(), run<Move<Chosen>>);
    };
    add_kinematics("velocity", LawConstant<Law::kMVN>{});
    add_kinematics("acceleration", LawConstant<Law::kMAN>{});
  });
  return true;
}

}  // namespace bench
