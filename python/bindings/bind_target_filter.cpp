#include "sources.hpp"

#include <limits>
#include <optional>
#include <string>

#include "arrays.hpp"

namespace fpbm::bindings {
namespace {

using Number = std::optional<double>;

template <typename Space>
Space space_of(const TargetFilter<Space>&) {
  return {};
}

/// A wrong shape is an error; the filter rejects invalid numbers.
template <typename Space>
typename Space::template Point<double> any_point(const ArrayLike& argument, const char* name) {
  if constexpr (std::is_same_v<Space, Pose>) {
    const auto H = matrix<Eigen::Matrix4d>(argument, name, 4, 4, true);
    Transform<> result{H.topRightCorner<3, 1>(), H.topLeftCorner<3, 3>()};
    if (H.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) result.p.setConstant(std::numeric_limits<double>::quiet_NaN());
    return result;
  } else {
    return any_vector<Space::kRows>(argument, name);
  }
}

PyTargetFilter target_filter(const ArrayLike& x0, double velocity, double acceleration, double jerk,
                             Number angular_velocity, Number angular_acceleration, Number angular_jerk,
                             const std::string& task, double dt, double timeout, Number start) {
  if (task != "position" && task != "pose")
    validation::reject("task", " = '" + task + "': must be 'position' or 'pose'");
  const auto make = [&](auto space) -> PyTargetFilter {
    using Space = decltype(space);
    TargetBounds<> bounds{velocity, acceleration, jerk};
    if constexpr (Space::kTurns > 0) {
      const auto given = [](const char* name, Number value) {
        if (!value) validation::reject(name, ": must be given, since the task has angles");
        return *value;
      };
      bounds.angular_velocity = given("angular_velocity", angular_velocity);
      bounds.angular_acceleration = given("angular_acceleration", angular_acceleration);
      bounds.angular_jerk = given("angular_jerk", angular_jerk);
    }
    return {TargetFilter<Space>(point<Space>(x0, "x0"), bounds, {dt, timeout, start})};
  };
  if (dimensions(x0) == 2) return make(Pose{});
  if (task == "pose") return make(PlanarPose{});
  return real_array(x0, "x0", 1).size() == 2 ? make(Position<2>{}) : make(Position<3>{});
}

}  // namespace

void bind_target_filter(py::module_& m) {
  const auto visit = [](auto visitor) {
    return [visitor](const PyTargetFilter& self) { return std::visit(visitor, self.any); };
  };
  const auto none = py::none();
  py::class_<PyTargetFilter>(m, "TargetFilter",
                             R"(Computes a smooth reference from targets that arrive at any rate, late, twice or never.

Along each axis of the base frame, the reference moves to the target in minimum time within the bounds, relative to the
moving target: without overshoot for a target at rest, without lag for a target with constant velocity. The velocity of
the target is estimated from the received points. If no message arrives within the timeout, the target stops. From rest,
an orientation rotates about a constant axis, and its largest angle changes in minimum time.

Parameters
----------
x0 : array_like, shape (2,), (3,) or (4, 4)
    Start of the reference, at rest, in the base frame [m, rad].
velocity, acceleration, jerk : float
    Bounds of each axis of the base frame, [m/s], [m/s^2] and [m/s^3].
angular_velocity, angular_acceleration, angular_jerk : float
    Bounds of the angle about each axis [rad/s], [rad/s^2] and [rad/s^3]; required for poses.
task : str
    'position' or 'pose'. With 'pose', shape (3,) is a pose in the plane.
dt : float
    Length of a tick [s].
timeout : float
    Time without a message after which a target stops and a twist ends [s].
start : float, optional
    Time of the first tick on the clock of the stamps [s]. Default: estimated from the stamps; the least delayed stamp
    counts as not delayed.

Raises
------
ParameterError
    If an argument is out of range.)")
      .def(py::init(&target_filter), py::arg("x0"), py::kw_only(), py::arg("velocity"), py::arg("acceleration"),
           py::arg("jerk"), py::arg("angular_velocity") = none, py::arg("angular_acceleration") = none,
           py::arg("angular_jerk") = none, py::arg("task") = "position", py::arg("dt") = TargetFilterOptions<>().dt,
           py::arg("timeout") = TargetFilterOptions<>().timeout, py::arg("start") = none)
      .def(
          "push",
          [](PyTargetFilter& self, const ArrayLike& x, Number stamp) {
            return std::visit(
                [&](auto& filter) {
                  const auto target = any_point<decltype(space_of(filter))>(x, "x");
                  return stamp ? filter.push(target, *stamp) : filter.push(target);
                },
                self.any);
          },
          py::arg("x"), py::arg("stamp") = none,
          R"(Adds a target with its stamp [s] on any clock; default: now.

Returns False for a rejected message, which has no effect: x or the stamp is not finite, R deviates from a rotation by
more than 1e-4, or the stamp is not newer than all previous stamps or is from the future. An accepted R becomes the
nearest rotation. Raises ParameterError if x has another shape than x0.)")
      .def(
          "push_twist",
          [](PyTargetFilter& self, const ArrayLike& v, Number stamp) {
            return std::visit(
                [&](auto& filter) {
                  const auto twist = any_vector<decltype(space_of(filter))::kRows>(v, "v");
                  return stamp ? filter.push_twist(twist, *stamp) : filter.push_twist(twist);
                },
                self.any);
          },
          py::arg("v"), py::arg("stamp") = none,
          R"(Sets a desired velocity [m/s, rad/s] until the timeout, within the bounds.

v has shape (m,), linear rows first, along the base frame's axes. Returns whether v is accepted, as push.)")
      .def(
          "set_speed",
          [](PyTargetFilter& self, double fraction) {
            if (!std::visit([&](auto& filter) { return filter.set_speed(fraction); }, self.any)) {
              validation::fail("fraction", fraction, "in (0, 1]");
            }
          },
          py::arg("fraction"),
          R"(Reduces the bounds on velocity to a fraction in (0, 1] of the given bounds, until the next call.

A faster reference decelerates within the bounds on acceleration and jerk. A faster target is followed with a lag.)")
      .def_property_readonly("speed", visit([](const auto& filter) { return filter.speed(); }),
                             "Fraction of the bounds on velocity that set_speed has set.")
      .def_property_readonly("x", visit([](const auto& filter) { return array_of(filter.reference().x); }),
                             "Reference at the start of the next tick, shape (2,), (3,) or (4, 4) [m, rad].")
      .def_property_readonly("xd", visit([](const auto& filter) { return array_of(filter.reference().xd); }),
                             "Velocity of the reference, shape (m,), linear rows first [m/s, rad/s].")
      .def_property_readonly("xdd", visit([](const auto& filter) { return array_of(filter.reference().xdd); }),
                             "Acceleration of the reference, shape (m,) [m/s^2, rad/s^2].")
      .def(
          "advance", [](PyTargetFilter& self) { std::visit([](auto& filter) { filter.advance(); }, self.any); },
          "Advances by one tick; Tracker.tick calls advance.")
      .def(
          "reset",
          [](PyTargetFilter& self, const ArrayLike& x) {
            std::visit([&](auto& filter) { filter.reset(point<decltype(space_of(filter))>(x, "x")); }, self.any);
          },
          py::arg("x"), "Restarts at rest at x, with the same speed; an estimated clock is discarded.");
}

}  // namespace fpbm::bindings
