#include <pybind11/pybind11.h>

#include "lane_run.hpp"

PYBIND11_MODULE(FPBM_LANE_MODULE, m) {
  using namespace fpbm::bindings;
  static const LaneCode code{
      kLanes, {&run_in_lanes<fpbm::Position<2>>, &run_in_lanes<fpbm::Position<3>>, &run_in_lanes<fpbm::Pose>}};
  m.doc() = "Motions side by side in the lanes of one kind of processor.";
  m.attr("code") = pybind11::capsule(&code, "fpbm_cpp.LaneCode");
}
