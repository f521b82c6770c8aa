#include "lane_code.hpp"
#include "lane_run.hpp"

namespace fpbm::bindings {

RunInLanes<Pose> pose_in_lanes() noexcept {
  return &run_in_lanes<Pose>;
}

}  // namespace fpbm::bindings
