#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fpbm/any/any_path.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/task/tip_bounds.hpp"

namespace fpbm::bindings {

/// A path in the task space that it was made in.
struct Path {
  std::variant<AnyPath<Position<2>>, AnyPath<PlanarPose>, AnyPath<Position<3>>, AnyPath<Pose>> any;

  [[nodiscard]] double duration() const {
    return std::visit([](const auto& path) { return path.duration(); }, any);
  }

  /// The path for a task in that space, as convert_path() makes it.
  /// Throws std::invalid_argument where the task cannot follow it.
  template <typename Space>
  [[nodiscard]] AnyPath<Space> as() const;
};

// The library's shapes and paths under their own names; law: the name of a time law. Each throws std::invalid_argument
// as they do.
[[nodiscard]] Path circle(double radius, double duration, const std::string& law);
[[nodiscard]] Path lissajous(const Vector<2>& amplitudes, double duration, const Vector<2, int>& frequencies,
                             double phase, const std::string& law);
[[nodiscard]] Path tricuspid(double size, double duration, const std::string& law);
[[nodiscard]] Path line(const Vector<2>& displacement, double duration, const std::string& law);
[[nodiscard]] Path line(const Vector<3>& displacement, double duration, const std::string& law);
[[nodiscard]] Path in_plane(const Path& path, const Vector<3>& u, const Vector<3>& v);
[[nodiscard]] Path with_rotation(const AnyPath<Position<2>>& path, double angle, const std::string& law);
[[nodiscard]] Path with_rotation(const AnyPath<Position<3>>& path, const Vector<3>& rotation, const std::string& law);

/// Paths one after another, in the smallest of the spaces that has room for all.
[[nodiscard]] Path sequence(const std::vector<const Path*>& paths);

/// When waypoints are passed: a duration, a time for each, or bounds of the tip's motion.
using Timing = std::variant<double, std::vector<double>, TipBounds<>>;
[[nodiscard]] Path waypoints(const std::vector<Vector<2>>& points, const Timing& timing);
[[nodiscard]] Path waypoints(const std::vector<Vector<3>>& points, const Timing& timing);
[[nodiscard]] Path waypoints(const std::vector<Transform<>>& points, const Timing& timing);

}  // namespace fpbm::bindings
