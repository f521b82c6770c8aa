#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "jobs.hpp"

// Under callgrind: one dump a job, named after it, of what the calls take that the argument asks for. See count.py.
namespace bench {
namespace {

template <typename Job>
void count(const std::string& row, int calls) {
  Job job;
  for (int i = 0; i < calls; ++i) job();  // Libraries are bound at the first.
  CALLGRIND_TOGGLE_COLLECT;
  for (int i = 0; i < calls; ++i) job();
  CALLGRIND_TOGGLE_COLLECT;
  CALLGRIND_DUMP_STATS_AT(row.c_str());
}

template <typename Case>
void count_steps(int calls) {
  for_each_law([=](auto law) { count<Step<Ours<Case, law()>>>("step/" + Case::name() + "/" + name(law), calls); });
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  if (argc != 2) {
    std::fprintf(stderr, "usage: valgrind --tool=callgrind --collect-atstart=no %s CALLS\n", argv[0]);
    return EXIT_FAILURE;
  }
  const int calls = std::atoi(argv[1]);
  count_steps<Case<Planar<4>, fpbm::Position<2>>>(calls);
  count_steps<PandaPose>(calls);
  count<Step<Ours<Case<Planar<7>, fpbm::Position<2>>, Law::kFPBM>>>("step/planar7/position/fpbm", calls);
  count<Step<Ours<Case<Panda, fpbm::Position<3>>, Law::kFPBM>>>("step/panda/position/fpbm", calls);
  count<Rk4Step<4, Law::kFPBM>>("rk4/planar4/position/fpbm", calls);
  count<Tick<false>>("loop/panda/pose/tick", calls);
  count<Tick<true>>("loop/panda/pose/tick_jerk", calls);
  count<Measured>("loop/panda/pose/measured", calls);
  count<FreeTick>("loop/panda/pose/free", calls);
  count<ClearTick>("loop/panda/pose/clear", calls);
  count<LimitedTick<fpbm::Pose, false>>("loop/panda/pose/limited", calls);
  count<LimitedTick<fpbm::Pose, true>>("loop/panda/pose/limited_jerk", calls);
  count<LimitedTick<fpbm::Position<3>, false>>("loop/panda/position/limited", calls);
  count<LimitedTick<fpbm::Position<3>, true>>("loop/panda/position/limited_jerk", calls);
}
