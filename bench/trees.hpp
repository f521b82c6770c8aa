#pragma once

#include <benchmark/benchmark.h>

#include "tree_kinematics.hpp"

// Rows of bench_trees: `trees/robot/quantity/library`.
namespace bench {

template <typename Solver, typename Case, Rates rates>
void run_tree(benchmark::State& bench) {
  const auto states = states_of<Case>();
  Solver solver;
  std::size_t turn = 0;
  for (auto _ : bench) {
    solver.template move<rates>(states[++turn % states.size()]);
    benchmark::DoNotOptimize(&solver);
    benchmark::ClobberMemory();
  }
}

template <template <typename> class Solver, typename Case>
void add_tree() {
  const auto add = [](const char* what, auto function) {
    benchmark::RegisterBenchmark(("trees/" + Case::name() + "/" + what + "/" + Solver<Case>::kLibrary).c_str(),
                                 function);
  };
  add("J", run_tree<Solver<Case>, Case, Rates::kNone>);
  add("J_and_Jd", run_tree<Solver<Case>, Case, Rates::kJacobian>);
  add("J_and_Jd_qd", run_tree<Solver<Case>, Case, Rates::kBias>);
}

}  // namespace bench
