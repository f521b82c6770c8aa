#include <pybind11/native_enum.h>

#include <optional>
#include <string>

#include "resolve.hpp"

namespace fpbm::bindings {
namespace {

/// Checks all parameters against each other by a trial run, for the number of joints that the parameters have.
void check(const Scheme& scheme) {
  Eigen::Index dof = 2;
  if (scheme.c) dof = scheme.c->size();
  if (scheme.rest_posture) dof = scheme.rest_posture->size();
  if (const auto* w = std::get_if<Scheme::Diagonal>(&scheme.weights)) dof = w->size();
  if (const auto* W = std::get_if<Scheme::Dense>(&scheme.weights)) dof = W->rows();
  validation::require_non_negative("manipulability_gain", scheme.manipulability_gain);
  const auto limits = JointLimits<kDynamic>::none(dof);
  (void)scheme.plain<Position<2>>(limits);
}

Scheme make_scheme(const std::string& level, const py::typing::Dict<py::str, py::object>& parameters) {
  const auto given = [&](const char* key) -> std::optional<py::object> {
    if (!parameters.contains(key) || py::object(parameters[key]).is_none()) return std::nullopt;
    return py::object(parameters[key]);
  };
  const auto number = [&](const char* key) {
    const auto value = given(key);
    return value ? py::cast<double>(*value) : 0.0;
  };
  const auto vector = [&](const char* key) -> std::optional<JointVector> {
    const auto value = given(key);
    if (!value) return std::nullopt;
    return joint_vector(ArrayLike(*value), key);
  };
  if (level != "velocity" && level != "acceleration") {
    validation::reject("level", " = '" + level + "': must be 'velocity' or 'acceleration'");
  }
  Scheme scheme{level == "velocity" ? Level::kVelocity : Level::kAcceleration};
  if (const auto weights = given("weights")) {
    const ArrayLike W(*weights);
    if (dimensions(W) == 2) {
      const auto dof = real_array(W, "weights", 2).shape(0);
      validation::require_dof("weights", dof, 1);
      scheme.weights = Scheme::Dense(matrix(W, "weights", dof, dof));
    } else {
      scheme.weights = joint_vector(W, "weights");
    }
  }
  for (const auto& [key, member] : kSchemeNumbers) scheme.*member = number(key);
  scheme.rest_posture = vector("rest_posture");
  scheme.c = vector("c");
  const SingularDamping<> singular(number("singular_radius"), number("singular_brake"));
  if (singular.radius() != 0.0) scheme.singular = singular;
  check(scheme);
  return scheme;
}

}  // namespace

void bind_scheme(py::module_& m) {
  py::native_enum<Status>(m, "Status", "enum.Enum", "Result of an evaluation or a rollout.")
      .value("OK", Status::kOk, "The motion is complete.")
      .value("COARSE", Status::kCoarse, "The motion is complete; the steps cause a discretisation error of the tip.")
      .value("DAMPED", Status::kDamped, "The motion is complete, and damped near a singular posture.")
      .value("SLOWED", Status::kSlowed, "Joint limits scale the task, or a lower level has stopped.")
      .value("BLOCKED", Status::kBlocked, "Self-collision, obstacles or task bounds limit the task.")
      .value("RECOVERING", Status::kRecovering,
             "The arm made no progress toward its target: it moves to a posture from which the target is reachable.")
      .value("STALLED", Status::kStalled, "The arm makes no progress toward its target: the arm stops.")
      .value("NOT_FOUND", Status::kNotFound, "No posture at the target was found.")
      .value("SINGULAR", Status::kSingular, "The posture is singular.")
      .value("TASK_LOST", Status::kTaskLost, "The tip has left its reference.")
      .value("NOT_FINITE", Status::kNotFinite, "A number is not finite.")
      .finalize();
  m.def("failed", &failed, py::arg("status"), "Whether the status means that there is no result.");
  m.def("message", &message, py::arg("status"), "Description of the status in one sentence.");
  m.def("advice", &advice, py::arg("status"), "Advice for the status in one sentence; empty for OK.");

  py::class_<Scheme>(m, "Scheme", "The compiled part of a scheme: the law of a level with its parameters.")
      .def(py::init(&make_scheme), py::arg("level"), py::arg("parameters"))
      .def("resolve", &resolve_for_arm, py::arg("arm"), py::arg("q"), py::arg("qd"), py::arg("x"), py::arg("xd"),
           py::arg("xdd") = py::none(), py::kw_only(), py::arg("task") = "position", py::arg("out") = py::none(),
           R"(Joint motion of the scheme in a state, or in each of k states.

Parameters
----------
arm : Arm
    The arm.
q, qd : array_like, shape (n,) or (k, n)
    Joint state [rad], [rad/s]. If q has k rows, each other argument has k entries along a leading axis, or one entry
    for all states.
x : array_like, shape (2,), (3,) or (4, 4)
    Reference of the tip in the base frame [m]; a pose is (x, y, angle) in the plane, a homogeneous matrix in space.
xd, xdd : array_like, shape (m,)
    Velocity and acceleration of the reference, linear rows first, then angular [m/s, rad/s]; xdd is optional at
    velocity level.
task : str
    'position' or 'pose'.
out : numpy.ndarray, shape (n,) or (k, n), optional
    Array of float64, C-contiguous, for the result.

Returns
-------
numpy.ndarray, shape (n,) or (k, n)
    qd [rad/s] at velocity level, qdd [rad/s^2] at acceleration level: out, or a new array.

Raises
------
ParameterError
    If an argument is not finite or has a wrong shape.
ResolutionError
    If the posture is singular or the result is not finite.)")
      .def("resolve", &resolve_for_kinematics, py::arg("kinematics"), py::arg("q"), py::arg("qd"), py::arg("x"),
           py::arg("xd"), py::arg("xdd") = py::none(), py::kw_only(), py::arg("out") = py::none(),
           "Joint motion of the scheme for tip, J and Jd from another library, as a Kinematics.");
}

}  // namespace fpbm::bindings
