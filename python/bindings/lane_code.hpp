#pragma once

#include "lanes.hpp"

namespace fpbm::bindings {

// Positions and poses are compiled in separate units (CMakeLists.txt), which limits the memory of the compiler.
[[nodiscard]] RunInLanes<Position<2>> plane_in_lanes() noexcept;
[[nodiscard]] RunInLanes<Position<3>> position_in_lanes() noexcept;
[[nodiscard]] RunInLanes<Pose> pose_in_lanes() noexcept;

template <int N>
[[nodiscard]] std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>& chain,
                                                                     const InverseOptions<>& options,
                                                                     const JointLimits<N>& limits);
extern template std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>&, const InverseOptions<>&,
                                                                       const JointLimits<6>&);
extern template std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>&, const InverseOptions<>&,
                                                                       const JointLimits<7>&);

}  // namespace fpbm::bindings
