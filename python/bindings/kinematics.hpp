#pragma once

#include <variant>

#include "arm.hpp"

namespace fpbm::bindings {

/// Tip, J and Jd in any task space, from an arm or from elsewhere.
struct PyKinematics {
  std::variant<Kinematics<Position<2>, kDynamic>, Kinematics<PlanarPose, kDynamic>, Kinematics<Position<3>, kDynamic>,
               Kinematics<Pose, kDynamic>>
      value;
  bool has_rate = true;  ///< Whether Jd is known.
};

/// One evaluation of a scheme, in code of run-time size. Throws std::invalid_argument where a parameter of the scheme
/// is for another number of joints.
template <typename Space>
[[nodiscard]] Status resolve(const PyScheme& scheme, const Kinematics<Space, kDynamic>& kinematics,
                             const Reference<Space>& reference, const State<kDynamic>& state, Joints& out);

}  // namespace fpbm::bindings
