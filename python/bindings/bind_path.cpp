#include <pybind11/typing.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fpbm/any/any_time_law.hpp"
#include "path.hpp"

namespace fpbm::bindings {
namespace {

using Array = py::array_t<double>;

/// One finite number.
double number(const ArrayLike& argument, const char* name) {
  const double value = *real_array(argument, name, 0).data();
  validation::require_finite(name, value);
  return value;
}

int dimensions(const ArrayLike& argument) {
  const auto any = py::array::ensure(argument);
  PyErr_Clear();
  return any ? static_cast<int>(any.ndim()) : -1;
}

Path python_lissajous(const ArrayLike& amplitude, double duration, const ArrayLike& frequencies, double phase,
                      const std::string& law) {
  const Vector<2> both = dimensions(amplitude) == 0 ? Vector<2>(Vector<2>::Constant(number(amplitude, "amplitude")))
                                                    : fixed_vector<2>(amplitude, "amplitude");
  return lissajous(both, duration, fixed_vector<2>(frequencies, "frequencies").cast<int>(), phase, law);
}

Path python_line(const ArrayLike& displacement, double duration, const std::string& law) {
  const bool spatial = real_array(displacement, "displacement", 1).size() == 3;
  if (spatial) return line(fixed_vector<3>(displacement, "displacement"), duration, law);
  return line(fixed_vector<2>(displacement, "displacement"), duration, law);
}

Path python_in_plane(const Path& path, const ArrayLike& axes) {
  const Eigen::MatrixXd rows = matrix(axes, "plane", 2, 3);
  return in_plane(path, rows.row(0).transpose(), rows.row(1).transpose());
}

Path python_with_rotation(const Path& path, const ArrayLike& rotation, const std::string& law) {
  if (const auto* flat = std::get_if<AnyPath<Position<2>>>(&path.any)) {
    return with_rotation(*flat, number(rotation, "rotation"), law);
  }
  const auto* spatial = std::get_if<AnyPath<Position<3>>>(&path.any);
  if (spatial == nullptr) validation::reject("with_rotation", ": the path rotates the tip already");
  return with_rotation(*spatial, fixed_vector<3>(rotation, "rotation"), law);
}

Path python_waypoints(const ArrayLike& points, const std::optional<double>& duration, const OptionalArray& times,
                      const std::optional<double>& velocity, const std::optional<double>& acceleration,
                      const std::optional<double>& angular_velocity,
                      const std::optional<double>& angular_acceleration) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const bool bounded = velocity || acceleration || angular_velocity || angular_acceleration;
  if (duration.has_value() + times.has_value() + bounded != 1) {
    validation::reject("duration", ", times or bounds of velocity: must be given, one of the three");
  }
  Timing timing = TipBounds<>{velocity.value_or(kNone), acceleration.value_or(kNone), angular_velocity.value_or(kNone),
                              angular_acceleration.value_or(kNone)};
  if (duration) timing = *duration;
  if (times) {
    const auto array = real_array(*times, "times", 1);
    timing = std::vector<double>(array.data(), array.data() + array.size());
  }
  if (dimensions(points) == 3) {
    const auto array = real_array(points, "points", 3);
    std::vector<Transform<>> poses;
    for (py::ssize_t i = 0; i < array.shape(0); ++i) {
      const std::string name = validation::element("points", i).text;
      poses.push_back(transform(ArrayLike(py::object(array[py::int_(i)])), name.c_str()));
    }
    return waypoints(poses, timing);
  }
  const auto array = real_array(points, "points", 2);
  const auto rows = [&](auto row) {
    std::vector<decltype(row)> result;
    for (py::ssize_t i = 0; i < array.shape(0); ++i) {
      for (py::ssize_t j = 0; j < array.shape(1); ++j) row(j) = array.at(i, j);
      result.push_back(row);
    }
    return waypoints(result, timing);
  };
  if (array.shape(1) == 2) return rows(Vector<2>{});
  if (array.shape(1) == 3) return rows(Vector<3>{});
  validation::reject("points", ": must have shape (k, 2), (k, 3) or (k, 4, 4), got " +
                                   py::cast<std::string>(py::str(array.attr("shape"))));
}

py::typing::Tuple<Array, Array, Array> sample(const Path& path, double t) {
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
      .def("_duration", &Path::duration)
      .def("sample", &sample, py::arg("t"),
           R"((x, xd, xdd) at t [s], as a displacement from where the tip starts [m, m/s, m/s^2].

x has shape (2,) or (3,), or (4, 4) where the path rotates the tip in space (in the plane: x, y, angle); xd and xdd have
shape (m,), linear rows first, then angular. At rest on the path's ends outside 0 <= t <= T.)");

  const auto duration = py::arg("duration");
  const auto law = py::arg("time_law");
  m.def("circle", &circle, py::arg("radius"), duration, law);
  m.def("lissajous", &python_lissajous, py::arg("amplitude"), duration, py::arg("frequencies"), py::arg("phase"), law);
  m.def("tricuspid", &tricuspid, py::arg("size"), duration, law);
  m.def("line", &python_line, py::arg("displacement"), duration, law);
  m.def("waypoints", &python_waypoints, py::arg("points"), duration, py::arg("times"), py::arg("velocity"),
        py::arg("acceleration"), py::arg("angular_velocity"), py::arg("angular_acceleration"));
  m.def("in_plane", &python_in_plane, py::arg("path"), py::arg("axes"));
  m.def("with_rotation", &python_with_rotation, py::arg("path"), py::arg("rotation"), law);
  m.def("sequence", &sequence, py::arg("paths"));
}

}  // namespace fpbm::bindings
