#pragma once

#include <variant>

#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/target/target_filter.hpp"

namespace fpbm::bindings {

/// A path in the task space for which it was constructed.
struct Path {
  std::variant<AnyPath<Position<2>>, AnyPath<PlanarPose>, AnyPath<Position<3>>, AnyPath<Pose>> any;

  [[nodiscard]] double duration() const {
    return std::visit([](const auto& path) { return path.duration(); }, any);
  }

  /// The path for a task in Space, as convert_path() makes it. Throws std::invalid_argument if the task cannot follow
  /// the path.
  template <typename Space>
  [[nodiscard]] AnyPath<Space> as() const;
};

/// A filter of targets in any task space.
struct PyTargetFilter {
  std::variant<TargetFilter<Position<2>>, TargetFilter<PlanarPose>, TargetFilter<Position<3>>, TargetFilter<Pose>> any;
};

}  // namespace fpbm::bindings
