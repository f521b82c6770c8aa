#include "arrays.hpp"
#include "bindings.hpp"
#include "path.hpp"
#include "text.hpp"

namespace fpbm::bindings {

namespace {

AnyTimeLaw time_law(const std::string& name) {
  if (name == "sin_squared") return {SinSquared{}};
  if (name == "quintic") return {Quintic{}};
  if (name == "constant_speed") return {ConstantSpeed{}};
  throw std::invalid_argument("time_law = '" + name + "': must be 'sin_squared', 'quintic' or 'constant_speed'");
}

/// "Name(first, …, duration=T, time_law='law')".
std::string describe(const std::string& head, double duration, const std::string& law) {
  return head + ", duration=" + text(duration) + ", time_law='" + law + "')";
}

template <typename Shape>
PyPath make_path(const Shape& shape, double duration, const std::string& law, const std::string& head) {
  return {AnyShape(shape), duration, time_law(law), describe(head, duration, law)};
}

}  // namespace

void bind_task(py::module_& m) {
  py::class_<PyPath>(m, "Path", R"(A shape run through under a time law in T seconds, then held.

A displacement from where the tip starts, so that x(0) = f(q0). The time laws give the fraction done, with tau = t/T:
'sin_squared', the paper's sin^2(pi tau / 2); 'quintic', 10 tau^3 - 15 tau^4 + 6 tau^5; 'constant_speed', tau.)")
      .def_property_readonly(
          "duration", [](const PyPath& path) { return path.duration(); }, "T [s].")
      .def(
          "sample",
          [](const PyPath& path, double t) {
            validation::require_finite("t", t);
            const Reference<Position<2>> reference = path.sample(t);
            return py::make_tuple(Eigen::Vector2d(reference.x), Eigen::Vector2d(reference.xd),
                                  Eigen::Vector2d(reference.xdd));
          },
          py::arg("t"),
          "(x, xd, xdd) at t [s], each of shape (2,) [m, m/s, m/s^2]; at rest on the path's ends outside 0 <= t <= T.")
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
             return PyCircle{make_path(Circle<double>(radius), duration, name, "Circle(" + text(radius))};
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
             return PyLissajous{make_path(
                 Lissajous<double>(both, frequencies, phase), duration, name,
                 "Lissajous(" + text(both) + ", frequencies=" + text(frequencies) + ", phase=" + text(phase))};
           }),
           py::arg("amplitude"), py::arg("duration"), py::kw_only(), py::arg("frequencies") = Vector<2, int>(2, 1),
           py::arg("phase") = kTurn / 12.0, law);

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
             return PyTricuspid{make_path(Tricuspid<double>(size), duration, name, "Tricuspid(" + text(size))};
           }),
           py::arg("size"), py::arg("duration"), py::kw_only(), law);

  struct PyLine : PyPath {};
  py::class_<PyLine, PyPath>(m, "Line", R"(Straight line.

Parameters
----------
displacement : array_like, shape (2,)
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
             const Vector<2> d = fixed_vector<2>(displacement, "displacement");
             return PyLine{make_path(Line<2>(d), duration, name, "Line(" + text(d))};
           }),
           py::arg("displacement"), py::arg("duration"), py::kw_only(), law);
}

}  // namespace fpbm::bindings
