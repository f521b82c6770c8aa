#include "tree_ticks.hpp"

// Compiled once for each robot: FPBM_ARMS Pandas on a torso of FPBM_TORSO joints.
namespace bench {
namespace {

[[maybe_unused]] const bool kAdded = add_growing_ticks<Pandas<FPBM_ARMS, FPBM_TORSO>>();

}  // namespace
}  // namespace bench
