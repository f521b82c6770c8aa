#include <pybind11/native_enum.h>

#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {
namespace {

[[noreturn]] void raise(Status status, const std::string& where = {}) {
  const py::object type = py::module_::import("fpbm_cpp.errors").attr("ResolutionError");
  const std::string text = where + message(status) + ". " + advice(status);
  py::set_error(type, type(py::cast(status), text));
  throw py::error_already_set();
}

void require_xdd(const Scheme& scheme, const OptionalArray& xdd) {
  if (scheme.level == Level::kAcceleration && !xdd) {
    validation::reject("xdd", ": must be given for an acceleration-level scheme");
  }
}

/// Joint motion of the scheme made(Space) in a state.
template <typename Space, typename Made>
Array resolve(const Scheme& scheme, const Kinematics<Space, kDynamic>& kinematics, const State<kDynamic>& state,
              const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd, const OptionalOut& out,
              const Made& made) {
  require_enough_joints<Space>(state.q.size());
  require_xdd(scheme, xdd);
  auto reference = Reference<Space>::hold(point<Space>(x, "x"));
  reference.xd = fixed_vector<Space::kRows>(xd, "xd");
  if (xdd) reference.xdd = fixed_vector<Space::kRows>(*xdd, "xdd");
  Array result = result_array(out, {state.q.size()});
  JointVector u = JointVector::Zero(state.q.size());
  const EitherScheme<Space>& either = made(Space{});
  const Status status =
      std::visit([&](const auto& any) { return any.resolve(kinematics, reference, state, u); }, either);
  if (failed(status)) raise(status);
  Eigen::Map<Eigen::VectorXd>(result.mutable_data(), u.size()) = u;
  return result;
}

/// Finite numbers of one shape: one value for each state, or one value for all states.
class PerState {
 public:
  using Shape = std::vector<py::ssize_t>;

  PerState(const ArrayLike& given, const char* name, const Shape& shape, py::ssize_t states)
      : shared_(dimensions(given) == static_cast<int>(shape.size())),
        values_(real_array(given, name, static_cast<int>(shape.size()) + (shared_ ? 0 : 1))),
        size_(values_.size() / (shared_ ? 1 : std::max<py::ssize_t>(values_.shape(0), 1))) {
    Shape required = shape;
    if (!shared_) required.insert(required.begin(), states);
    for (std::size_t i = 0; i < required.size(); ++i) {
      if (values_.shape(static_cast<py::ssize_t>(i)) == required[i]) continue;
      validation::reject(name, ": must have shape " + shape_text(required) + ", got " + shape_text(values_));
    }
    for (py::ssize_t i = 0; i < values_.size(); ++i) {
      const double value = values_.data()[i];
      if (std::isfinite(value)) continue;
      const validation::Argument state = validation::element(name, shared_ ? i % size_ : i / size_);
      validation::fail(state, value, "finite");
    }
  }

  [[nodiscard]] const double* at(py::ssize_t state) const noexcept {
    return values_.data() + (shared_ ? 0 : state * size_);
  }

 private:
  bool shared_;
  py::array_t<double, py::array::c_style> values_;
  py::ssize_t size_;
};

/// resolve() in many states. scheme: for the arm. An argument with one value holds for all states.
template <typename Space, typename Any>
Array resolve_many(const Scheme& scheme, const Any& arm, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                   const ArrayLike& xd, const OptionalArray& xdd, const OptionalOut& out) {
  const py::ssize_t dof = arm.dof();
  require_enough_joints<Space>(dof);
  require_xdd(scheme, xdd);
  const py::ssize_t states = real_array(q, "q", 2).shape(0);
  const PerState qs(q, "q", {dof}, states);
  const PerState qds(qd, "qd", {dof}, states);
  const PerState points(x, "x", std::is_same_v<Space, Pose> ? PerState::Shape{4, 4} : PerState::Shape{Space::kSize},
                        states);
  const PerState xds(xd, "xd", {Space::kRows}, states);
  std::optional<PerState> xdds;
  if (xdd) xdds.emplace(*xdd, "xdd", PerState::Shape{Space::kRows}, states);
  const EitherScheme<Space> either = scheme.make<Space>(arm);
  Array result = result_array(out, {states, dof});
  std::visit(
      [&](const auto& any) {
        using Row = Eigen::Map<const Vector<Space::kRows>>;
        Kinematics<Space, kDynamic> kinematics;
        State<kDynamic> state;
        JointVector u = JointVector::Zero(dof);
        for (py::ssize_t i = 0; i < states; ++i) {
          state.q = Eigen::Map<const Eigen::VectorXd>(qs.at(i), dof);
          state.qd = Eigen::Map<const Eigen::VectorXd>(qds.at(i), dof);
          arm.kinematics(state.q, state.qd, kinematics);
          const auto name = [i] { return validation::element("x", i); };
          auto reference = Reference<Space>::hold(point_at<Space>(points.at(i), name));
          reference.xd = Row(xds.at(i));
          if (xdds) reference.xdd = Row(xdds->at(i));
          const Status status = any.resolve(kinematics, reference, state, u);
          if (failed(status)) raise(status, "state " + std::to_string(i) + ": ");
          Eigen::Map<Eigen::VectorXd>(result.mutable_data(i), dof) = u;
        }
      },
      either);
  return result;
}

/// Joint motion of a scheme for an arm in a state, or in each of several states along a leading axis. The result is
/// returned and, if out is given, written to out. After an error, out has the motions of the preceding states.
Array resolve_for_arm(const Scheme& given, const Arm& arm, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                      const ArrayLike& xd, const OptionalArray& xdd, const std::string& task, const OptionalOut& out) {
  std::optional<Scheme> with_dynamics;
  if (given.uses_dynamics) with_dynamics = given.on(arm);
  const Scheme& scheme = with_dynamics ? *with_dynamics : given;
  return arm.visit(task, [&](const auto& any, auto space) {
    using Space = decltype(space);
    if (py::isinstance<py::array>(q) ? py::array(q).ndim() == 2 : dimensions(q) == 2) {
      return resolve_many<Space>(scheme, any, q, qd, x, xd, xdd, out);
    }
    const State<kDynamic> state{joint_vector(q, "q", arm.dof()), joint_vector(qd, "qd", arm.dof())};
    Kinematics<Space, kDynamic> kinematics;
    any.kinematics(state.q, state.qd, kinematics);
    std::optional<EitherScheme<Space>> of_arm;
    return resolve(scheme, kinematics, state, x, xd, xdd, out, [&](auto) -> const EitherScheme<Space>& {
      return scheme.needs_arm() ? of_arm.emplace(scheme.make<Space>(any))
                                : scheme.kept<Space>(arm.dof(), any.limits().continuous);
    });
  });
}

/// Joint motion of a scheme in one state, for tip, J and Jd from another library.
Array resolve_for_kinematics(const Scheme& scheme, const AnyKinematics& kinematics, const ArrayLike& q,
                             const ArrayLike& qd, const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd,
                             const OptionalOut& out) {
  if (!kinematics.has_rate && scheme.level == Level::kAcceleration) {
    validation::reject("Jd", ": must be given for an acceleration-level scheme");
  }
  return std::visit(
      [&](const auto& known) {
        const auto dof = static_cast<int>(known.J.cols());
        const State<kDynamic> state{joint_vector(q, "q", dof), joint_vector(qd, "qd", dof)};
        return resolve(
            scheme, known, state, x, xd, xdd,
            out, [&](auto space) -> const auto& { return scheme.kept<decltype(space)>(dof); });
      },
      kinematics.value);
}

/// Checks all parameters against each other by a trial run, for the number of joints that the parameters have.
void check(const Scheme& scheme) {
  Eigen::Index dof = 2;
  if (scheme.c) dof = scheme.c->size();
  if (scheme.rest_posture) dof = scheme.rest_posture->size();
  if (const auto* w = std::get_if<Scheme::Diagonal>(&scheme.weights)) dof = w->size();
  if (const auto* W = std::get_if<Scheme::Dense>(&scheme.weights)) dof = W->rows();
  validation::require_non_negative("manipulability_gain", scheme.manipulability_gain);
  Scheme without_dynamics = scheme;
  without_dynamics.uses_dynamics = false;
  (void)without_dynamics.plain<Position<2>>(JointLimits<kDynamic>::none(dof));
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
  scheme.uses_dynamics = number("uses_dynamics") != 0.0;
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
