#include "lane_code.hpp"
#include "lane_run.hpp"

namespace fpbm::bindings {

RunInLanes<Position<2>> plane_in_lanes() noexcept {
  return &run_in_lanes<Position<2>>;
}

}  // namespace fpbm::bindings
