#include "lane_run.hpp"

namespace fpbm::bindings {

RunInLanes<Position<2>> plane_in_lanes() noexcept {
  return &run_in_lanes<Position<2>>;
}
RunInLanes<Position<3>> position_in_lanes() noexcept {
  return &run_in_lanes<Position<3>>;
}

}  // namespace fpbm::bindings
