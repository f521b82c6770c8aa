#include "tree_ticks.hpp"

// Rows with promises: bench/promises.py.
namespace bench {
namespace {

[[maybe_unused]] const bool kAdded = [] {
  add_ticks<Pandas<2, 0>, false, 0>("two_poses", two_poses<Pandas<2, 0>>);
  add_ticks<UpperBodyInMotion, true, 1>("grasp", grasp<UpperBodyInMotion>);
  add_ticks<Pandas<2, 3>, true, 1>("grasp", grasp<Pandas<2, 3>>);
  return true;
}();

}  // namespace
}  // namespace bench
