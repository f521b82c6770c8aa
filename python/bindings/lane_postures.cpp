#include "fpbm/core/lanes.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "lane_code.hpp"

namespace fpbm::bindings {

template <int N>
std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>& chain, const InverseOptions<>& options,
                                                       const JointLimits<N>& limits) {
  // Four lanes, also where eight fit: the first attempt that reaches the target ends the search (make inverse).
  constexpr int kLanes = 4;
  using Inverse = InverseKinematics<SerialArm<N>, Pose, Lanes<kLanes>>;
  return std::make_unique<PostureSolverOf<Inverse, Pose>>(Inverse(SerialArm<N>(chain), Pose{}, options, limits));
}

template std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>&, const InverseOptions<>&,
                                                                const JointLimits<6>&);
template std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>&, const InverseOptions<>&,
                                                                const JointLimits<7>&);

}  // namespace fpbm::bindings
