#include "step.hpp"

namespace bench {
namespace {

[[maybe_unused]] const bool kAdded = [] {
  add_library<Ours>();
  // With damping near singular postures, as in a control loop.
  for_each_case([](auto arm_and_task) { add_step<Ours<decltype(arm_and_task), Law::kFPBM, true>>(); });
  return true;
}();

}  // namespace
}  // namespace bench
