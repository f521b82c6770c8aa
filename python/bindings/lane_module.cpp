#include <pybind11/pybind11.h>

#include "lane_run.hpp"

namespace fpbm::bindings {

extern template void run_in_lanes(const PlanarArm<4>&, const AnyPath<Position<2>>&, const TimeGrid<double>&,
                                  const PyScheme* const*, const Vector<Eigen::Dynamic>*, const std::atomic<bool>&,
                                  Outcome*);
extern template void run_in_lanes(const SerialArm<7>&, const AnyPath<Position<3>>&, const TimeGrid<double>&,
                                  const PyScheme* const*, const Vector<Eigen::Dynamic>*, const std::atomic<bool>&,
                                  Outcome*);
extern template void run_in_lanes(const SerialArm<7>&, const AnyPath<Pose>&, const TimeGrid<double>&,
                                  const PyScheme* const*, const Vector<Eigen::Dynamic>*, const std::atomic<bool>&,
                                  Outcome*);

}  // namespace fpbm::bindings

PYBIND11_MODULE(FPBM_LANE_MODULE, m) {
  using namespace fpbm::bindings;
  static const LaneCode code{
      kLanes,
      {&run_in_lanes<fpbm::PlanarArm<4>, fpbm::Position<2>>, &run_in_lanes<fpbm::SerialArm<7>, fpbm::Position<3>>,
       &run_in_lanes<fpbm::SerialArm<7>, fpbm::Pose>}};
  m.doc() = "Motions side by side in the lanes of one kind of processor.";
  m.attr("code") = pybind11::capsule(&code, "fpbm_cpp.LaneCode");
}
