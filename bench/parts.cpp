#include "step.hpp"
#include "torch.hpp"

// Parts of a step of this library, and combinations of steps: rows resolve/…, rk4/…, loop/…
namespace bench {
namespace {

template <typename Job>
void add(const std::string& row) {
  benchmark::RegisterBenchmark((row + "/fpbm_cpp").c_str(), run<Job>);
}

template <typename Case>
void add_resolve() {
  for_each_law([](auto law) { add<Resolve<Ours<Case, law()>>>("resolve/" + Case::name() + "/" + name(law)); });
  add<Resolve<Ours<Case, Law::kFPBM, true>>>("resolve/" + Case::name() + "/fpbm_damped");
}

[[maybe_unused]] const bool kAdded = [] {
  add_resolve<Case<Planar<4>, fpbm::Position<2>>>();
  add_resolve<PandaPose>();
  for_each_law([](auto law) { add<Rk4Step<4, law()>>(std::string("rk4/planar4/position/") + name(law)); });
  add<Step<Ours<PandaPose, Law::kFPBM, true>>>("step/panda/pose/fpbm_damped");
  add<Step<TorchSolver>>("step/ur5e/torch/fpbm_damped");
  // A swinging Panda alone, and with shapes of which 26 pairs are closer than 15 cm.
  add<FreeTick>("loop/panda/pose/free");
  add<ClearTick>("loop/panda/pose/clear");
  return true;
}();

}  // namespace
}  // namespace bench
