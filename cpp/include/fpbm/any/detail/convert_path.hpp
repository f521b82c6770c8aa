#pragma once

#include <type_traits>

#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/path/placed.hpp"

namespace fpbm {

/// Path for a task in the space To. A planar path is placed in the xy plane of space. For a path of positions and a
/// space To of poses, the orientation of the tip is constant. Throws ParameterError if a task in To cannot follow the
/// path.
template <typename To, typename From>
[[nodiscard]] AnyPath<To> convert_path(const AnyPath<From>& path) {
  constexpr bool kFlat = std::is_same_v<To, Position<2>> || std::is_same_v<To, PlanarPose>;
  if constexpr (std::is_same_v<To, From>) {
    return path;
  } else if constexpr (std::is_same_v<From, PlanarPose> || std::is_same_v<From, Pose>) {
    if constexpr (kFlat == std::is_same_v<From, PlanarPose>) {
      validation::reject("path", ": rotates the tip, which needs task='pose'");
    } else if constexpr (kFlat) {
      validation::reject("path", ": is in space, and the arm is planar: must be a planar path");
    } else {
      validation::reject("path",
                         ": rotates the tip in a plane, and the task is in space: call in_plane before with_rotation");
    }
  } else if constexpr (kFlat && std::is_same_v<From, Position<3>>) {
    validation::reject("path", ": is in space, and the arm is planar: must be a planar path");
  } else if constexpr (std::is_same_v<To, Position<3>>) {
    return AnyPath<To>(InPlane(path, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}));
  } else if constexpr (std::is_same_v<typename PoseOver<From>::type, To>) {
    return AnyPath<To>(WithRotation(path));
  } else {
    return convert_path<To>(convert_path<Position<3>>(path));
  }
}

}  // namespace fpbm
