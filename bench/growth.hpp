#pragma once

#include "step.hpp"

// Steps of FPBM on arms of n joints, and their kinematics alone, with n fixed at compile time or given at run time:
// rows growth/planar/step/fixed/n, …
namespace bench {

template <typename Robot, typename Space>
void add_growth(const std::string& kind, const char* size, int n) {
  using Solver = Ours<Case<Robot, Space>, Law::kFPBM>;
  const std::string end = std::string("/") + size + "/" + std::to_string(n);
  benchmark::RegisterBenchmark(("growth/" + kind + "/kinematics" + end).c_str(), run<Move<Solver>>);
  benchmark::RegisterBenchmark(("growth/" + kind + "/step" + end).c_str(), run<Step<Solver>>);
}

}  // namespace bench
