#include <valgrind/callgrind.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "jobs.hpp"
#include "torch.hpp"

// Under callgrind: a dump for each call, named after its job (count.py).
// Under lackey, which traces memory: each call is between two stores to `mark`. stalls.py reads the address of `mark`
// and the names of the jobs from the standard output.
namespace bench {
namespace {

volatile std::uint64_t mark = 0;

/// Selected jobs. If empty: all jobs.
std::vector<std::string> selected;

template <typename Job>
void count(const std::string& row, int calls) {
  if (!selected.empty() && std::find(selected.begin(), selected.end(), row) == selected.end()) return;
  std::printf("%s\n", row.c_str());
  Job job;
  for (int i = 0; i < calls; ++i) job();  // The first call binds the libraries.
  for (int i = 0; i < calls; ++i) {
    CALLGRIND_TOGGLE_COLLECT;
    mark = 1;
    job();
    mark = 0;
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT(row.c_str());
  }
}

template <typename Case>
void count_steps(int calls) {
  for_each_law([=](auto law) { count<Step<Ours<Case, law()>>>("step/" + Case::name() + "/" + name(law), calls); });
}

/// FPBM with damping enabled, in regular postures and in postures with active damping; its kinematics and its scheme.
template <typename Case>
void count_parts(int calls) {
  const std::string row = "/" + Case::name();
  using Damped = Ours<Case, Law::kFPBM, true>;
  count<Step<Damped>>("step" + row + "/fpbm_damped", calls);
  count<Step<Ours<NearSingular<Case>, Law::kFPBM, true>>>("step" + row + "/fpbm_damped_singular", calls);
  count<Move<Damped>>("kinematics" + row, calls);
  count<Resolve<Ours<Case, Law::kFPBM>>>("resolve" + row + "/fpbm", calls);
  count<Resolve<Damped>>("resolve" + row + "/fpbm_damped", calls);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  if (argc < 2) {
    std::fprintf(stderr, "usage: valgrind --tool=callgrind --collect-atstart=no %s CALLS [JOB …]\n", argv[0]);
    return EXIT_FAILURE;
  }
  selected.assign(argv + 2, argv + argc);
  const int calls = std::atoi(argv[1]);
  count<Nothing>("nothing", calls);
  count_steps<Case<Planar<4>, fpbm::Position<2>>>(calls);
  count_steps<PandaPose>(calls);
  count_parts<Case<Planar<4>, fpbm::Position<2>>>(calls);
  count_parts<PandaPose>(calls);
  count<Step<Ours<Case<Planar<7>, fpbm::Position<2>>, Law::kFPBM>>>("step/planar7/position/fpbm", calls);
  count<Step<Ours<Case<Panda, fpbm::Position<3>>, Law::kFPBM>>>("step/panda/position/fpbm", calls);
  count<Step<TorchSolver>>("step/ur5e/torch/fpbm_damped", calls);
  count<Rk4Step<4, Law::kFPBM>>("rk4/planar4/position/fpbm", calls);
  count<Tick<false>>("loop/panda/pose/tick", calls);
  count<Tick<true>>("loop/panda/pose/tick_jerk", calls);
  count<Measured>("loop/panda/pose/measured", calls);
  count<FreeTick>("loop/panda/pose/free", calls);
  count<ClearTick>("loop/panda/pose/clear", calls);
  count<FreeTorqueTick>("loop/panda/pose/free_torque", calls);
  count<TorqueTick>("loop/panda/posture/torque", calls);
  count<LimitedTick<fpbm::Pose, false>>("loop/panda/pose/limited", calls);
  count<LimitedTick<fpbm::Pose, true>>("loop/panda/pose/limited_jerk", calls);
  count<LimitedTick<fpbm::Position<3>, false>>("loop/panda/position/limited", calls);
  count<LimitedTick<fpbm::Position<3>, true>>("loop/panda/position/limited_jerk", calls);
}
