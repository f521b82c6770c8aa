#pragma once

#include <variant>

#include "arm.hpp"

namespace fpbm::bindings {

/// Tip, J and Jd in any task space, from an arm or from elsewhere.
struct AnyKinematics {
  std::variant<Kinematics<Position<2>, kDynamic>, Kinematics<PlanarPose, kDynamic>, Kinematics<Position<3>, kDynamic>,
               Kinematics<Pose, kDynamic>>
      value;
  bool has_rate = true;  ///< Whether Jd is known.
};

}  // namespace fpbm::bindings
