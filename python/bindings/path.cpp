#include "path.hpp"

#include <algorithm>

#include "fpbm/any/any_time_law.hpp"
#include "fpbm/any/convert_path.hpp"
#include "fpbm/task/in_plane.hpp"
#include "fpbm/task/path.hpp"
#include "fpbm/task/sequence.hpp"
#include "fpbm/task/waypoints.hpp"
#include "fpbm/task/with_rotation.hpp"

namespace fpbm::bindings {
namespace {

/// A shape run through under a time law.
template <typename Shape>
Path make_path(const Shape& shape, double duration, const std::string& law) {
  return {AnyPath<typename Shape::Space>(fpbm::Path(shape, duration, AnyTimeLaw(law)))};
}

/// Paths in [begin, end) one after another, as a balanced tree of pairs: a sample goes through few of them.
template <typename Space>
AnyPath<Space> sequence_in(const Path* const* begin, const Path* const* end) {
  if (end - begin == 1) return (*begin)->as<Space>();
  const auto* const middle = begin + (end - begin) / 2;
  return AnyPath<Space>(Sequence(sequence_in<Space>(begin, middle), sequence_in<Space>(middle, end)));
}

template <typename Space>
Path make_waypoints(const std::vector<typename Space::template Point<double>>& points, const Timing& timing) {
  using Spline = Waypoints<Space>;
  if (const auto* duration = std::get_if<double>(&timing)) return {AnyPath<Space>(Spline::lasting(points, *duration))};
  if (const auto* bounds = std::get_if<TipBounds<>>(&timing)) return {AnyPath<Space>(Spline::within(points, *bounds))};
  return {AnyPath<Space>(Spline(points, std::get<std::vector<double>>(timing)))};
}

}  // namespace

template <typename Space>
AnyPath<Space> Path::as() const {
  return std::visit([](const auto& path) { return convert_path<Space>(path); }, any);
}

template AnyPath<Position<2>> Path::as() const;
template AnyPath<PlanarPose> Path::as() const;
template AnyPath<Position<3>> Path::as() const;
template AnyPath<Pose> Path::as() const;

Path circle(double radius, double duration, const std::string& law) {
  return make_path(Circle<double>(radius), duration, law);
}

Path lissajous(const Vector<2>& amplitudes, double duration, const Vector<2, int>& frequencies, double phase,
               const std::string& law) {
  return make_path(Lissajous<double>(amplitudes, frequencies, phase), duration, law);
}

Path tricuspid(double size, double duration, const std::string& law) {
  return make_path(Tricuspid<double>(size), duration, law);
}

Path line(const Vector<2>& displacement, double duration, const std::string& law) {
  return make_path(Line<2>(displacement), duration, law);
}

Path line(const Vector<3>& displacement, double duration, const std::string& law) {
  return make_path(Line<3>(displacement), duration, law);
}

Path in_plane(const Path& path, const Vector<3>& u, const Vector<3>& v) {
  const auto* flat = std::get_if<AnyPath<Position<2>>>(&path.any);
  if (flat == nullptr) validation::reject("in_plane", ": the path must be one of positions in a plane");
  return {AnyPath<Position<3>>(InPlane(*flat, u, v))};
}

Path with_rotation(const AnyPath<Position<2>>& path, double angle, const std::string& law) {
  return {AnyPath<PlanarPose>(WithRotation(path, Vector<1>(angle), AnyTimeLaw(law)))};
}

Path with_rotation(const AnyPath<Position<3>>& path, const Vector<3>& rotation, const std::string& law) {
  return {AnyPath<Pose>(WithRotation(path, rotation, AnyTimeLaw(law)))};
}

Path sequence(const std::vector<const Path*>& paths) {
  if (paths.empty()) validation::reject("paths", ": must be one at least");
  const auto in = [&](auto space) {
    return Path{sequence_in<decltype(space)>(paths.data(), paths.data() + paths.size())};
  };
  const auto has = [&](std::size_t kind) {
    return std::any_of(paths.begin(), paths.end(), [&](const Path* path) { return path->any.index() == kind; });
  };
  if (has(3)) return in(Pose{});
  if (has(2)) return in(Position<3>{});
  if (has(1)) return in(PlanarPose{});
  return in(Position<2>{});
}

Path waypoints(const std::vector<Vector<2>>& points, const Timing& timing) {
  return make_waypoints<Position<2>>(points, timing);
}

Path waypoints(const std::vector<Vector<3>>& points, const Timing& timing) {
  return make_waypoints<Position<3>>(points, timing);
}

Path waypoints(const std::vector<Transform<>>& points, const Timing& timing) {
  return make_waypoints<Pose>(points, timing);
}

}  // namespace fpbm::bindings
