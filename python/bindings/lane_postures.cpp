#include "fpbm/core/lanes.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "lane_code.hpp"

namespace fpbm::bindings {

template <int N>
std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>& chain, const InverseOptions<>& options,
                                                       const JointLimits<N>& limits) {
  constexpr int kLanes = static_cast<int>(std::experimental::native_simd<double>::size());
  using Inverse = InverseKinematics<SerialArm<N>, Pose, Lanes<kLanes>>;
  return std::make_unique<PostureSolverOf<Inverse, Pose>>(Inverse(SerialArm<N>(chain), Pose{}, options, limits));
}

template std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>&, const InverseOptions<>&,
                                                                const JointLimits<6>&);
template std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>&, const InverseOptions<>&,
                                                                const JointLimits<7>&);

}  // namespace fpbm::bindings
