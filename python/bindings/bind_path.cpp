#include <pybind11/typing.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "fpbm/any/detail/any_time_law.hpp"
#include "fpbm/any/detail/convert_path.hpp"
#include "fpbm/path/at_speed.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/placed.hpp"
#include "fpbm/path/polyline.hpp"
#include "fpbm/path/waypoints.hpp"
#include "sources.hpp"

namespace fpbm::bindings {
namespace {

/// A path without a duration: the geometry of a path, with the duration NaN.
template <typename Space_>
struct Untimed {
  using Scalar = double;
  using Space = Space_;

  AnyPath<Space> geometry;

  [[nodiscard]] double duration() const noexcept { return std::numeric_limits<double>::quiet_NaN(); }
  [[nodiscard]] Reference<Space> sample(double t) const noexcept { return geometry.sample(t); }
};

std::optional<double> duration_of(const Path& path) {
  const double duration = path.duration();
  return std::isnan(duration) ? std::nullopt : std::optional(duration);
}

void require_duration(const Path& path) {
  if (!duration_of(path)) {
    validation::reject("path", ": has no duration: give a duration, or use fastest(), or keep_path=True");
  }
}

}  // namespace

template <typename Space>
AnyPath<Space> Path::as() const {
  require_duration(*this);
  return std::visit([](const auto& path) { return convert_path<Space>(path); }, any);
}

template AnyPath<Position<2>> Path::as() const;
template AnyPath<PlanarPose> Path::as() const;
template AnyPath<Position<3>> Path::as() const;
template AnyPath<Pose> Path::as() const;

namespace {

/// A path along a shape, with the time law of that name.
template <typename Shape>
Path make_path(const Shape& shape, double duration, const std::string& law) {
  return {AnyPath<typename Shape::Space>(fpbm::Path(shape, duration, AnyTimeLaw(law)))};
}

Path circle(double radius, double duration, const std::string& law) {
  return make_path(Circle<double>(radius), duration, law);
}

Path lissajous(const ArrayLike& amplitude, double duration, const ArrayLike& frequencies, double phase,
               const std::string& law) {
  const Vector<2> both = dimensions(amplitude) == 0 ? Vector<2>(Vector<2>::Constant(py::cast<double>(amplitude)))
                                                    : fixed_vector<2>(amplitude, "amplitude");
  return make_path(Lissajous<double>(both, fixed_vector<2>(frequencies, "frequencies").cast<int>(), phase), duration,
                   law);
}

Path tricuspid(double size, double duration, const std::string& law) {
  return make_path(Tricuspid<double>(size), duration, law);
}

Path line(const ArrayLike& displacement, double duration, const std::string& law) {
  const bool spatial = real_array(displacement, "displacement", 1).size() == 3;
  if (spatial) return make_path(Line<3>(fixed_vector<3>(displacement, "displacement")), duration, law);
  return make_path(Line<2>(fixed_vector<2>(displacement, "displacement")), duration, law);
}

Path in_plane(const Path& path, const ArrayLike& axes) {
  const auto* flat = std::get_if<AnyPath<Position<2>>>(&path.any);
  if (flat == nullptr) {
    validation::reject("in_plane",
                       ": the path must be planar and without rotation: call in_plane before with_rotation");
  }
  const Matrix<2, 3> rows = matrix(axes, "plane", 2, 3);
  return {AnyPath<Position<3>>(InPlane(*flat, Vector<3>(rows.row(0)), Vector<3>(rows.row(1))))};
}

Path with_rotation(const Path& path, const ArrayLike& rotation, const std::string& law) {
  if (const auto* flat = std::get_if<AnyPath<Position<2>>>(&path.any)) {
    return {AnyPath<PlanarPose>(
        WithRotation(*flat, Vector<1>(*real_array(rotation, "rotation", 0).data()), AnyTimeLaw(law)))};
  }
  const auto* spatial = std::get_if<AnyPath<Position<3>>>(&path.any);
  if (spatial == nullptr) {
    validation::reject("with_rotation", ": the path rotates the tip already: must be a path of positions");
  }
  return {AnyPath<Pose>(WithRotation(*spatial, fixed_vector<3>(rotation, "rotation"), AnyTimeLaw(law)))};
}

/// The paths in [begin, end) one after another, as a balanced tree of pairs: a sample evaluates few pairs.
template <typename Space>
AnyPath<Space> sequence_in(const Path* const* begin, const Path* const* end) {
  if (end - begin == 1) return (*begin)->as<Space>();
  const auto* const middle = begin + (end - begin) / 2;
  return AnyPath<Space>(Sequence(sequence_in<Space>(begin, middle), sequence_in<Space>(middle, end)));
}

/// Paths one after another, in the smallest space that contains all of them.
Path sequence(const std::vector<const Path*>& paths) {
  if (paths.empty()) validation::reject("paths", ": must have at least one path");
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

/// Timing of waypoints: a duration, the time of each waypoint, or bounds of the tip's motion.
using Timing = std::variant<double, std::vector<double>, TipBounds<>>;

template <typename Space>
Path waypoints_in(const std::vector<typename Space::template Point<double>>& points, const Timing& timing) {
  using Spline = Waypoints<Space>;
  if (const auto* duration = std::get_if<double>(&timing)) return {AnyPath<Space>(Spline::lasting(points, *duration))};
  if (const auto* bounds = std::get_if<TipBounds<>>(&timing)) return {AnyPath<Space>(Spline::within(points, *bounds))};
  return {AnyPath<Space>(Spline(points, std::get<std::vector<double>>(timing)))};
}

/// The entries of an array of points.
template <typename Space>
std::vector<typename Space::template Point<double>> points_of(const Array& array) {
  std::vector<typename Space::template Point<double>> points;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    points.push_back(point_at<Space>(array.data(i), [i] { return validation::element("points", i); }));
  }
  return points;
}

/// Calls f(points) with the points of an array, in their space.
template <typename F>
Path with_points(const ArrayLike& points, const F& f) {
  const bool poses = dimensions(points) == 3;
  const Array array = real_array(points, "points", poses ? 3 : 2);
  if (poses) return f(Pose{}, points_of<Pose>(array));
  return array.shape(1) == 2 ? f(Position<2>{}, points_of<Position<2>>(array))
                             : f(Position<3>{}, points_of<Position<3>>(array));
}

Path waypoints(const ArrayLike& points, const std::optional<double>& duration, const OptionalArray& times,
               const std::optional<double>& velocity, const std::optional<double>& acceleration,
               const std::optional<double>& angular_velocity, const std::optional<double>& angular_acceleration,
               const std::optional<double>& jerk, const std::optional<double>& angular_jerk) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const bool bounded = velocity || acceleration || angular_velocity || angular_acceleration || jerk || angular_jerk;
  if (duration.has_value() + times.has_value() + bounded != 1) {
    validation::reject("duration", ", times or bounds of velocity: must be given, at most one of the three");
  }
  Timing timing = TipBounds<>{velocity.value_or(kNone),
                              acceleration.value_or(kNone),
                              angular_velocity.value_or(kNone),
                              angular_acceleration.value_or(kNone),
                              jerk.value_or(kNone),
                              angular_jerk.value_or(kNone)};
  if (duration) timing = *duration;
  if (times) {
    const auto array = real_array(*times, "times", 1);
    timing = std::vector<double>(array.data(), array.data() + array.size());
  }
  return with_points(points, [&](auto space, const auto& each) { return waypoints_in<decltype(space)>(each, timing); });
}

Path polyline(const ArrayLike& points, double duration, double blend, const std::string& law) {
  return with_points(points, [&](auto space, const auto& each) {
    return make_path(Polyline<decltype(space)>(each, blend), duration, law);
  });
}

Path at_speed(const Path& path, double speed, double acceleration, const std::optional<double>& jerk) {
  return std::visit(
      [&](const auto& any) -> Path {
        const AtSpeed at(any, speed, acceleration, jerk.value_or(std::numeric_limits<double>::infinity()));
        return {std::decay_t<decltype(any)>(at)};
      },
      path.any);
}

/// The path without its duration.
Path untimed(const Path& path) {
  return std::visit(
      [](const auto& any) -> Path {
        using Any = std::decay_t<decltype(any)>;
        return {Any(Untimed<typename Any::Space>{any})};
      },
      path.any);
}

py::typing::Tuple<Array, Array, Array> sample(const Path& path, double t) {
  require_duration(path);
  validation::require_finite("t", t);
  return std::visit(
      [t](const auto& any) {
        const auto reference = any.sample(t);
        return py::make_tuple(array_of(reference.x), array_of(reference.xd), array_of(reference.xdd));
      },
      path.any);
}

}  // namespace

void bind_path(py::module_& m) {
  const auto& laws = AnyTimeLaw::kNames;
  m.attr("TIME_LAWS") = py::make_tuple(laws[0], laws[1], laws[2]);
  py::class_<Path>(m, "Path", "The compiled part of a path.")
      .def(py::init<const Path&>(), py::arg("path"))
      .def("_duration", &duration_of)
      .def("_require_duration", &require_duration)
      .def("sample", &sample, py::arg("t"),
           R"((x, xd, xdd) at t [s], as a displacement from the start of the tip [m, m/s, m/s^2].

x has shape (2,) or (3,); if the path rotates the tip, shape (4, 4) in space, (x, y, angle) in the plane. xd and xdd
have shape (m,), linear rows first, then angular. Outside 0 <= t <= T, the reference is at rest at the path's ends.)");

  const auto duration = py::arg("duration");
  const auto law = py::arg("time_law");
  m.def("circle", &circle, py::arg("radius"), duration, law);
  m.def("lissajous", &lissajous, py::arg("amplitude"), duration, py::arg("frequencies"), py::arg("phase"), law);
  m.def("tricuspid", &tricuspid, py::arg("size"), duration, law);
  m.def("line", &line, py::arg("displacement"), duration, law);
  m.def("polyline", &polyline, py::arg("points"), duration, py::arg("blend"), law);
  m.def("waypoints", &waypoints, py::arg("points"), duration, py::arg("times"), py::arg("velocity"),
        py::arg("acceleration"), py::arg("angular_velocity"), py::arg("angular_acceleration"), py::arg("jerk"),
        py::arg("angular_jerk"));
  m.def("in_plane", &in_plane, py::arg("path"), py::arg("axes"));
  m.def("with_rotation", &with_rotation, py::arg("path"), py::arg("rotation"), law);
  m.def("at_speed", &at_speed, py::arg("path"), py::arg("speed"), py::arg("acceleration"), py::arg("jerk"));
  m.def("sequence", &sequence, py::arg("paths"));
  m.def("untimed", &untimed, py::arg("path"));
}

}  // namespace fpbm::bindings
