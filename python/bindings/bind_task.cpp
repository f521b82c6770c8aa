#include <array>
#include <limits>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fpbm/task/in_plane.hpp"
#include "fpbm/task/sequence.hpp"
#include "fpbm/task/shapes.hpp"
#include "fpbm/task/time_law.hpp"
#include "fpbm/task/waypoints.hpp"
#include "fpbm/task/with_rotation.hpp"
#include "path.hpp"
#include "recipe.hpp"
#include "text.hpp"

namespace fpbm::bindings {

namespace {

/// Calls visitor(law) with the time law of that name.
template <typename Visitor>
auto visit_time_law(const std::string& name, Visitor&& visitor) {
  if (name == "sin_squared") return visitor(SinSquared{});
  if (name == "quintic") return visitor(Quintic{});
  if (name == "constant_speed") return visitor(ConstantSpeed{});
  throw std::invalid_argument("time_law = '" + name + "': must be 'sin_squared', 'quintic' or 'constant_speed'");
}

/// A shape run through under a time law: "Name(first, …, duration=T, time_law='law')", which is Type(first, duration,
/// time_law=law, others...).
template <typename Type, typename Shape, typename First, typename... Others>
Type make_path(const Shape& shape, double duration, const std::string& law, const std::string& head, const First& first,
               Others&&... others) {
  return visit_time_law(law, [&](const auto& chosen) {
    return Type{
        {AnyPath<typename Shape::Space>(Path(shape, duration, chosen)),
         head + ", duration=" + text(duration) + ", time_law='" + law + "')",
         recipe(py::type::of<Type>(), first, duration, py::arg("time_law") = law, std::forward<Others>(others)...)}};
  });
}

/// Directions of a path's x and y axes in space: two of the base frame's, or any two.
std::array<Vector<3>, 2> plane_axes(const py::object& plane) {
  if (py::isinstance<py::str>(plane)) {
    const auto name = py::cast<std::string>(plane);
    const std::string axes = "xyz";
    if (name.size() == 2 && name[0] != name[1] && axes.find(name[0]) < 3 && axes.find(name[1]) < 3) {
      const auto unit = [&](char axis) {
        return Vector<3>(Vector<3>::Unit(static_cast<Eigen::Index>(axes.find(axis))));
      };
      return {unit(name[0]), unit(name[1])};
    }
    throw std::invalid_argument("plane = '" + name + "': must be two of 'x', 'y' and 'z', as in 'yz'");
  }
  const Eigen::MatrixXd rows = matrix(ArrayLike(plane), "plane", 2, 3);
  return {Vector<3>(rows.row(0).transpose()), Vector<3>(rows.row(1).transpose())};
}

PyPath in_plane(const PyPath& path, const py::object& plane) {
  const auto [u, v] = plane_axes(plane);
  const auto* flat = std::get_if<AnyPath<Position<2>>>(&path.path);
  if (flat == nullptr) throw std::invalid_argument("in_plane: the path must be one of positions in a plane");
  return {AnyPath<Position<3>>(InPlane(*flat, u, v)),
          path.repr + ".in_plane(" + py::cast<std::string>(py::repr(plane)) + ")",
          recipe_of_method("in_plane", path, copy_of(plane))};
}

PyPath with_rotation(const PyPath& path, const ArrayLike& turn, const std::string& law) {
  return visit_time_law(law, [&](const auto& chosen) {
    return std::visit(
        [&](const auto& positions) -> PyPath {
          using Positions = typename std::decay_t<decltype(positions)>::Space;
          if constexpr (std::is_same_v<Positions, Position<2>> || std::is_same_v<Positions, Position<3>>) {
            using Turned = WithRotation<AnyPath<Positions>, std::decay_t<decltype(chosen)>>;
            typename Turned::Turn r;
            if constexpr (r.RowsAtCompileTime == 1) {
              if (real_array(turn, "turn", 0).size() != 1) throw std::invalid_argument("turn: must be one angle");
              r(0) = py::cast<double>(turn);
            } else {
              r = fixed_vector<3>(turn, "turn");
            }
            return {AnyPath<typename Turned::Space>(Turned(positions, r, chosen)),
                    path.repr + ".with_rotation(" + py::cast<std::string>(py::repr(turn)) + ", time_law='" + law + "')",
                    recipe_of_method("with_rotation", path, copy_of(turn), py::arg("time_law") = law)};
          } else {
            throw std::invalid_argument("with_rotation: the path turns the tip already");
          }
        },
        path.path);
  });
}

/// Both paths in the smaller of the spaces that has room for both.
PyPath then(const PyPath& first, const PyPath& second) {
  const auto in = [&](auto tag) {
    using Space = decltype(tag);
    return PyPath{AnyPath<Space>(Sequence(first.as<Space>(), second.as<Space>())),
                  first.repr + ".then(" + second.repr + ")", recipe_of_method("then", first, second)};
  };
  const auto among = [&](std::size_t kind) { return first.path.index() == kind || second.path.index() == kind; };
  if (among(3)) return in(Pose{});
  if (among(2)) return in(Position<3>{});
  if (among(1)) return in(PlanarPose{});
  return in(Position<2>{});
}

/// Waypoints in one of the three ways of timing them.
template <typename Space>
PyPath make_waypoints(const std::vector<typename Space::template Point<double>>& points,
                      const std::optional<double>& duration, const OptionalArray& times,
                      const std::optional<TipBounds<>>& bounds) {
  const auto described = [&points](const Waypoints<Space>& path) {
    return PyPath{AnyPath<Space>(path),
                  "Waypoints(<" + std::to_string(points.size()) + " points>, duration=" + text(path.duration()) + ")",
                  nullptr};
  };
  if (duration) return described(Waypoints<Space>::lasting(points, *duration));
  if (bounds) return described(Waypoints<Space>::within(points, *bounds));
  const auto array = real_array(*times, "times", 1);
  return described(Waypoints<Space>(points, std::vector<double>(array.data(), array.data() + array.size())));
}

PyPath waypoints(const ArrayLike& points, const std::optional<double>& duration, const OptionalArray& times,
                 const std::optional<double>& speed, const std::optional<double>& acceleration,
                 const std::optional<double>& angular_velocity, const std::optional<double>& angular_acceleration) {
  std::optional<TipBounds<>> bounds;
  if (speed || acceleration || angular_velocity || angular_acceleration) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    bounds = TipBounds<>{speed.value_or(kNone), acceleration.value_or(kNone), angular_velocity.value_or(kNone),
                         angular_acceleration.value_or(kNone)};
  }
  if (duration.has_value() + times.has_value() + bounds.has_value() != 1) {
    throw std::invalid_argument("duration, times or bounds of speed: must be given, one of the three");
  }
  const auto any = py::array::ensure(points);
  PyErr_Clear();
  if (any && any.ndim() == 3) {
    const auto array = real_array(points, "points", 3);
    std::vector<Transform<>> poses;
    for (py::ssize_t i = 0; i < array.shape(0); ++i) {
      const std::string name = validation::element("points", i);
      poses.push_back(transform(ArrayLike(py::object(array[py::int_(i)])), name.c_str()));
    }
    return make_waypoints<Pose>(poses, duration, times, bounds);
  }
  const auto array = real_array(points, "points", 2);
  const auto rows = [&](auto tag) {
    using Space = decltype(tag);
    std::vector<Vector<Space::kRows>> result;
    for (py::ssize_t i = 0; i < array.shape(0); ++i) {
      result.push_back(Eigen::Map<const Vector<Space::kRows>>(array.data(i, 0)));
    }
    return make_waypoints<Space>(result, duration, times, bounds);
  };
  if (array.shape(1) == 2) return rows(Position<2>{});
  if (array.shape(1) == 3) return rows(Position<3>{});
  throw std::invalid_argument("points: must have shape (k, 2), (k, 3) or (k, 4, 4), got (" +
                              std::to_string(array.shape(0)) + ", " + std::to_string(array.shape(1)) + ")");
}

}  // namespace

void bind_task(py::module_& m) {
  py::class_<PyPath>(m, "Path", R"(Where the tip is to be, over T seconds, from rest to rest; then held.

A displacement from where the tip starts, so that x(0) = f(q0). Paths of positions in the plane lie in the xy plane
unless in_plane() lays them elsewhere; paths of positions leave the tip's orientation free under task='position' and
hold it under task='pose', unless with_rotation() turns it.

The time laws give the fraction done, with tau = t/T: 'sin_squared', the paper's sin^2(pi tau / 2), whose acceleration
steps at both ends; 'quintic', 10 tau^3 - 15 tau^4 + 6 tau^5, whose acceleration is zero there; 'constant_speed', tau.)")
      .def_property_readonly("duration", &PyPath::duration, "T [s].")
      .def(
          "sample",
          [](const PyPath& path, double t) {
            validation::require_finite("t", t);
            return std::visit(
                [t](const auto& any) {
                  const auto reference = any.sample(t);
                  return py::make_tuple(array_of(reference.x), array_of(reference.xd), array_of(reference.xdd));
                },
                path.path);
          },
          py::arg("t"),
          R"((x, xd, xdd) at t [s], as a displacement from where the tip starts [m, m/s, m/s^2].

x has shape (2,) or (3,), or (4, 4) where the path turns the tip in space (in the plane: x, y, angle); xd and xdd have
shape (m,), linear rows first, then angular. At rest on the path's ends outside 0 <= t <= T.)")
      .def("in_plane", &in_plane, py::arg("plane"),
           R"(This path of the plane laid into a plane of space.

plane: the base frame's axes that its x and y run along, as in 'yz', or any two directions at right angles,
shape (2, 3).)")
      .def("with_rotation", &with_rotation, py::arg("turn"), py::kw_only(), py::arg("time_law") = "quintic",
           R"(This path of positions with the tip turned on the way, from rest to rest over its whole duration.

turn: rotation vector along the base frame's axes [rad], shape (3,), or an angle in the plane, from the orientation that
the tip starts in. To end in an orientation R: rotation_vector(R @ R0.T). Zero holds the orientation.)")
      .def("then", &then, py::arg("path"), "This path, and from its end another.")
      .def("__reduce__", &reduce<PyPath>)
      .def("__repr__", [](const PyPath& path) { return path.repr; });

  const auto law = py::arg("time_law") = "sin_squared";

  struct PyCircle : PyPath {};
  py::class_<PyCircle, PyPath>(m, "Circle", R"(Circle, counter-clockwise from its rightmost point.

r (cos phi - 1, sin phi), phi = 2 pi s.

Parameters
----------
radius : float
    r [m], positive.
duration : float
    T [s], positive.
time_law : str
    'sin_squared', 'quintic' or 'constant_speed'.

Raises
------
ValueError
    Where a number is not positive and finite, or the time law is unknown.)")
      .def(py::init([](double radius, double duration, const std::string& name) {
             return make_path<PyCircle>(Circle<double>(radius), duration, name, "Circle(" + text(radius), radius);
           }),
           py::arg("radius"), py::arg("duration"), py::kw_only(), law);

  struct PyLissajous : PyPath {};
  py::class_<PyLissajous, PyPath>(m, "Lissajous", R"(Lissajous figure.

(a_x (cos(f_x phi + delta) - cos delta), a_y (sin(f_y phi + delta) - sin delta)), phi = 2 pi s.

Parameters
----------
amplitude : float or (float, float)
    a [m], one for both axes or one each, positive.
duration : float
    T [s], positive.
frequencies : (int, int)
    f, whole and positive, so that the figure closes.
phase : float
    delta [rad].
time_law : str
    'sin_squared', 'quintic' or 'constant_speed'.

Raises
------
ValueError
    Where a number is out of range or not finite, or the time law is unknown.)")
      .def(py::init([](const ArrayLike& amplitude, double duration, const Vector<2, int>& frequencies, double phase,
                       const std::string& name) {
             const bool one = py::isinstance<py::float_>(amplitude) || py::isinstance<py::int_>(amplitude);
             const Vector<2> both =
                 one ? Vector<2>::Constant(py::cast<double>(amplitude)) : fixed_vector<2>(amplitude, "amplitude");
             return make_path<PyLissajous>(
                 Lissajous<double>(both, frequencies, phase), duration, name,
                 "Lissajous(" + text(both) + ", frequencies=" + text(frequencies) + ", phase=" + text(phase), both,
                 py::arg("frequencies") = frequencies, py::arg("phase") = phase);
           }),
           py::arg("amplitude"), py::arg("duration"), py::kw_only(), py::arg("frequencies") = Vector<2, int>(2, 1),
           py::arg("phase") = kTwoPi / 12.0, law);

  struct PyTricuspid : PyPath {};
  py::class_<PyTricuspid, PyPath>(m, "Tricuspid", R"(Tricuspid (deltoid), from its rightmost cusp.

a (2 cos phi + cos 2 phi - 3, 2 sin phi - sin 2 phi), phi = 2 pi s.

Parameters
----------
size : float
    a [m], positive.
duration : float
    T [s], positive.
time_law : str
    'sin_squared', 'quintic' or 'constant_speed'.

Raises
------
ValueError
    Where a number is not positive and finite, or the time law is unknown.)")
      .def(py::init([](double size, double duration, const std::string& name) {
             return make_path<PyTricuspid>(Tricuspid<double>(size), duration, name, "Tricuspid(" + text(size), size);
           }),
           py::arg("size"), py::arg("duration"), py::kw_only(), law);

  struct PyLine : PyPath {};
  py::class_<PyLine, PyPath>(m, "Line", R"(Straight line.

Parameters
----------
displacement : array_like, shape (2,) or (3,)
    From the start of the line to its end [m].
duration : float
    T [s], positive.
time_law : str
    'sin_squared', 'quintic' or 'constant_speed'.

Raises
------
ValueError
    Where a number is not finite, the duration not positive, or the time law unknown.)")
      .def(py::init([](const ArrayLike& displacement, double duration, const std::string& name) {
             if (real_array(displacement, "displacement", 1).size() == 3) {
               const Vector<3> d = fixed_vector<3>(displacement, "displacement");
               return make_path<PyLine>(Line<3>(d), duration, name, "Line(" + text(d), d);
             }
             const Vector<2> d = fixed_vector<2>(displacement, "displacement");
             return make_path<PyLine>(Line<2>(d), duration, name, "Line(" + text(d), d);
           }),
           py::arg("displacement"), py::arg("duration"), py::kw_only(), law);

  struct PyWaypoints : PyPath {};
  py::class_<PyWaypoints, PyPath>(m, "Waypoints", R"(A smooth path through points, from rest to rest.

A quintic spline: of all curves through the points at those times, the one of least jerk. Acceleration is continuous
everywhere, the ends included. Orientations are splines of quaternions, and turn by the shorter way.

Parameters
----------
points : array_like, shape (k, 2), (k, 3) or (k, 4, 4)
    Positions [m] or poses, two at least. Only differences from the first matter, since a path starts where the tip is:
    coordinates in the base frame do as well as displacements.
duration : float
    T [s]; each piece gets its share by its length.
times : array_like, shape (k,)
    When each point is passed [s], the first at 0.
speed, acceleration, angular_velocity, angular_acceleration : float
    As fast as these bounds of the tip's motion allow [m/s, m/s^2, rad/s, rad/s^2], to 1 %; T is rounded up to 0.01 s.

Raises
------
ValueError
    Where not just one of duration, times and bounds is given, a number is out of range or not finite, or two points
    that follow each other are one.)")
      .def(py::init([](const ArrayLike& points, const std::optional<double>& duration, const OptionalArray& times,
                       const std::optional<double>& speed, const std::optional<double>& acceleration,
                       const std::optional<double>& angular_velocity, const std::optional<double>& angular_acceleration) {
             PyWaypoints path{waypoints(points, duration, times, speed, acceleration, angular_velocity, angular_acceleration)};
             path.recipe = recipe(py::type::of<PyWaypoints>(), copy_of(points), py::arg("duration") = duration,
                                  py::arg("times") = copy_of(times), py::arg("speed") = speed,
                                  py::arg("acceleration") = acceleration, py::arg("angular_velocity") = angular_velocity,
                                  py::arg("angular_acceleration") = angular_acceleration);
             return path;
           }),
           py::arg("points"), py::kw_only(), py::arg("duration") = py::none(), py::arg("times") = py::none(),
           py::arg("speed") = py::none(), py::arg("acceleration") = py::none(), py::arg("angular_velocity") = py::none(),
           py::arg("angular_acceleration") = py::none());
}

}  // namespace fpbm::bindings
