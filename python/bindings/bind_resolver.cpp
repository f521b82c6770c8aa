#include <memory>
#include <string>

#include "bindings.hpp"
#include "kinematics.hpp"
#include "py_arm.hpp"
#include "recipe.hpp"
#include "scheme_init.hpp"
#include "whole_arm.hpp"

#include <pybind11/native_enum.h>

namespace fpbm::bindings {
namespace {

template <Level kLevel_>
struct PySchemeAt : PyScheme {
  static constexpr Level kLevel = kLevel_;
};
struct PyMVN : PySchemeAt<Level::kVelocity> {};
struct PyWMVN : PySchemeAt<Level::kVelocity> {};
struct PyMAN : PySchemeAt<Level::kAcceleration> {};
struct PyWMVNAcceleration : PySchemeAt<Level::kAcceleration> {};
struct PyBalanced : PySchemeAt<Level::kAcceleration> {};
struct PyFPBM : PySchemeAt<Level::kAcceleration> {};

[[noreturn]] void raise(Status status) {
  const py::object type = py::module_::import("fpbm_cpp._errors").attr("ResolutionError");
  PyErr_SetObject(type.ptr(), type(py::cast(status)).ptr());
  throw py::error_already_set();
}

template <typename Known>
struct SpaceOfKinematics;
template <typename Space, int N, typename Scalar>
struct SpaceOfKinematics<Kinematics<Space, N, Scalar>> {
  using type = Space;
};
template <typename Known>
using SpaceOf = typename SpaceOfKinematics<Known>::type;

/// One evaluation in a task space, of an arm or of known kinematics.
template <typename Space, typename Source>
Eigen::VectorXd resolve_task(const PyScheme& scheme, const Source& source, const State<kDynamic>& state,
                             const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd) {
  constexpr int kRows = Space::kRows;
  require_redundant(kRows, static_cast<int>(state.q.size()));
  Reference<Space> reference{point<Space>(x, "x"), fixed_vector<kRows>(xd, "xd"), Vector<kRows>::Zero()};
  if (xdd) {
    reference.xdd = fixed_vector<kRows>(*xdd, "xdd");
  } else if (scheme.level() == Level::kAcceleration) {
    throw std::invalid_argument("xdd: an acceleration-level scheme needs it");
  }
  Joints out = Joints::Zero(state.q.size());
  const Status status = resolve(scheme, source, reference, state, out);
  if (failed(status)) raise(status);
  return out;
}

/// The arm's poses, where it has such in space.
std::shared_ptr<const TaskModel<Pose>> poses_of(const PyArm& arm) {
  return arm.visit("pose", [](const auto& model) -> std::shared_ptr<const TaskModel<Pose>> {
    if constexpr (std::is_same_v<std::decay_t<decltype(model)>, TaskModel<Pose>>) return borrowed(model);
    return nullptr;
  });
}

Eigen::VectorXd resolve_for_arm(const PyScheme& scheme, const PyArm& arm, const ArrayLike& q, const ArrayLike& qd,
                                const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd,
                                const std::string& task) {
  const State<kDynamic> state{joint_vector(q, "q", arm.dof()), joint_vector(qd, "qd", arm.dof())};
  return arm.visit(task, [&](const auto& model) {
    using Space = typename std::decay_t<decltype(model)>::Space;
    const WholeArm<Space> whole{borrowed<TaskModel<Space>>(model), poses_of(arm), arm.limits()};
    return resolve_task<Space>(scheme, whole, state, x, xd, xdd);
  });
}

Eigen::VectorXd resolve_for_kinematics(const PyScheme& scheme, const PyKinematics& kinematics, const ArrayLike& q,
                                       const ArrayLike& qd, const ArrayLike& x, const ArrayLike& xd,
                                       const OptionalArray& xdd) {
  if (!kinematics.has_rate && scheme.level() == Level::kAcceleration) {
    throw std::invalid_argument("Jd: an acceleration-level scheme needs it");
  }
  return std::visit(
      [&](const auto& known) {
        const auto dof = static_cast<int>(known.J.cols());
        const State<kDynamic> state{joint_vector(q, "q", dof), joint_vector(qd, "qd", dof)};
        return resolve_task<SpaceOf<std::decay_t<decltype(known)>>>(scheme, known, state, x, xd, xdd);
      },
      kinematics.value);
}

/// The tip of an arm on a point.
PyPointTask point_task(const PyArm& arm, const ArrayLike& x, double k1, double k2) {
  validation::require_non_negative("k1", k1);
  validation::require_non_negative("k2", k2);
  return arm.visit("position", [&](const auto& model) -> PyPointTask {
    using Space = typename std::decay_t<decltype(model)>::Space;
    if constexpr (std::is_same_v<Space, Position<2>> || std::is_same_v<Space, Position<3>>) {
      const auto at = point<Space>(x, "x");
      return {{PySecondTask::Point<Space>{arm.positions<Space>(), arm.dof(), at}, k1, k2,
               "SecondTask(arm of " + std::to_string(arm.dof()) + " joints, x=" + text(at) + ", k1=" + text(k1) +
                   ", k2=" + text(k2) + ")",
               recipe(py::type::of<PyPointTask>(), py::cast(arm, py::return_value_policy::reference), at,
                      py::arg("k1") = k1, py::arg("k2") = k2)}};
    }
    throw std::invalid_argument("arm: must have positions");
  });
}

PyGaze gaze(const ArrayLike& direction, double k1, double k2) {
  validation::require_non_negative("k1", k1);
  validation::require_non_negative("k2", k2);
  const Vector<3> d = fixed_vector<3>(direction, "direction");
  if (d.isZero(0.0)) validation::fail("direction", 0.0, "longer: it must point somewhere");
  return {{PySecondTask::Direction{d}, k1, k2, "Gaze(" + text(d) + ", k1=" + text(k1) + ", k2=" + text(k2) + ")",
           recipe(py::type::of<PyGaze>(), d, py::arg("k1") = k1, py::arg("k2") = k2)}};
}

void bind_second_tasks(py::module_& m) {
  py::class_<PyPointTask>(m, "SecondTask", R"(A point for a second arm's tip, in the null space of the first task.

The second arm is of the first joints of the first one: its tip an elbow, say. The first task comes strictly first.

Parameters
----------
arm : Arm
    The second arm: PlanarArm(lengths[:k]), or SerialArm.from_joints(joints[:k]).
x : array_like, shape (2,) or (3,)
    Where its tip is to be, in the base frame [m].
k1, k2 : float
    Feedback gains on velocity [1/s], which velocity-level schemes do without, and position [1/s^2], or [1/s] at
    velocity level; not negative.

Raises
------
ValueError
    Where an argument is out of range, not finite, or of the wrong shape.)")
      .def(py::init(&point_task), py::arg("arm"), py::arg("x"), py::kw_only(), py::arg("k1") = 10.0,
           py::arg("k2") = 25.0)
      .def("__reduce__", &reduce<PyPointTask>)
      .def("__repr__", [](const PyPointTask& task) { return task.repr; });
  py::class_<PyGaze>(m, "Gaze", R"(A direction for the tip's z axis, in the null space of the first task.

Of an arm in space; the axis may still turn about itself. The first task comes strictly first.

Parameters
----------
direction : array_like, shape (3,)
    Where the axis is to point, in the base frame; its length does not matter.
k1, k2 : float
    Feedback gains on velocity [1/s], which velocity-level schemes do without, and direction [1/s^2], or [1/s] at
    velocity level; not negative.

Raises
------
ValueError
    Where an argument is out of range, not finite, or of the wrong shape.)")
      .def(py::init(&gaze), py::arg("direction"), py::kw_only(), py::arg("k1") = 10.0, py::arg("k2") = 25.0)
      .def("__reduce__", &reduce<PyGaze>)
      .def("__repr__", [](const PyGaze& task) { return task.repr; });
}

std::string text_of(const char* summary, const char* own, const char* options) {
  return std::string(summary) + kParameters + own + options;
}

void bind_velocity_schemes(py::module_& m) {
  py::class_<PyMVN, PyScheme> mvn(
      m, "MVN",
      text_of("Minimum velocity norm, (6): qd = J+ xd; with c the general solution (3).", "", kVelocityOptions)
          .c_str());
  const auto make_mvn = [](double k) {
    PyScheme scheme = begin(Law::kWMVN, "MVN");
    set_gain(scheme, k);
    return scheme;
  };
  define_init(mvn, +make_mvn, py::kw_only(), py::arg("k") = 0.0);

  py::class_<PyWMVN, PyScheme> wmvn(
      m, "WMVN",
      text_of("Weighted minimum velocity norm, (7): qd = J_W+ xd, of least qd' W qd.", kWeightsText, kVelocityOptions)
          .c_str());
  const auto make_wmvn = [](const ArrayLike& weights, double k) {
    PyScheme scheme = begin(Law::kWMVN, "WMVN");
    set_weights(scheme, weights);
    set_gain(scheme, k);
    return scheme;
  };
  define_init(wmvn, +make_wmvn, py::arg("weights"), py::kw_only(), py::arg("k") = 0.0);
}

PyScheme make_balanced(const char* name, double alpha, const ArrayLike& weights) {
  PyScheme scheme = begin(Law::kFPBM, name);
  scheme.alpha = alpha;
  scheme.repr += "alpha=" + text(alpha) + ", ";
  set_weights(scheme, weights);
  return scheme;
}

void bind_acceleration_schemes(py::module_& m) {
  py::class_<PyMAN, PyScheme> man(
      m, "MAN",
      text_of("Minimum acceleration norm, (8): qdd = J+ (xdd - Jd qd); with c the general solution (5).", "",
              kAccelerationOptions)
          .c_str());
  const auto make_man = [] { return begin(Law::kMAN, "MAN"); };
  define_init(man, +make_man, py::kw_only());

  py::class_<PyWMVNAcceleration, PyScheme> wmvn(
      m, "WMVNAcceleration",
      text_of("Weighted minimum velocity norm at acceleration level, (9), which is (7) differentiated.\n\n"
              "qdd = J_W+ (xdd - Jd qd) + N_W W^-1 Jd' (J W^-1 J')^-1 xd.",
              kWeightsText, kAccelerationOptions)
          .c_str());
  const auto make_wmvn = [](const ArrayLike& weights) {
    PyScheme scheme = begin(Law::kFPBM, "WMVNAcceleration");
    scheme.alpha = 1.0;
    set_weights(scheme, weights);
    return scheme;
  };
  define_init(wmvn, +make_wmvn, py::arg("weights"), py::kw_only());

  py::class_<PyBalanced, PyScheme> balanced(
      m, "Balanced",
      text_of("Balance of MAN and WMVN without feedback, (16): (1 - alpha) MAN (8) + alpha WMVN (9).",
              (std::string(kAlphaText) + kWeightsText).c_str(), kAccelerationOptions)
          .c_str());
  const auto make = [](double alpha, const ArrayLike& weights) { return make_balanced("Balanced", alpha, weights); };
  define_init(balanced, +make, py::arg("alpha"), py::arg("weights"), py::kw_only());

  const std::string own = std::string(kAlphaText) + kWeightsText +
                          "\nk1, k2 : float\n    Feedback gains on velocity [1/s] and position [1/s^2], not negative.";
  py::class_<PyFPBM, PyScheme> fpbm(
      m, "FPBM",
      text_of("Feedback-added pseudoinverse-type balanced minimisation, (13).\n\n"
              "The balance (16) with b = xdd - Jd qd + k1 (xd - J qd) + k2 (x - f(q)) in place of xdd - Jd qd, so\n"
              "that the tip error e obeys e'' + k1 e' + k2 e = 0 whatever alpha and W.",
              own.c_str(), kAccelerationOptions)
          .c_str());
  const auto make_fpbm = [](double alpha, const ArrayLike& weights, double k1, double k2) {
    PyScheme scheme = make_balanced("FPBM", alpha, weights);
    scheme.k1 = k1;
    scheme.k2 = k2;
    scheme.repr += ", k1=" + text(k1) + ", k2=" + text(k2);
    return scheme;
  };
  define_init(fpbm, +make_fpbm, py::arg("alpha"), py::arg("weights"), py::arg("k1"), py::arg("k2"), py::kw_only());
}

}  // namespace

void bind_resolver(py::module_& m) {
  py::native_enum<Status>(m, "Status", "enum.Enum", "What became of an evaluation or a rollout.")
      .value("OK", Status::kOk, "The motion is complete.")
      .value("DAMPED", Status::kDamped, "The motion is complete; damped near a singular posture.")
      .value("SLOWED", Status::kSlowed, "The motion is slowed by joint limits.")
      .value("SINGULAR", Status::kSingular, "The posture is singular.")
      .value("TASK_LOST", Status::kTaskLost, "The tip has left its reference.")
      .value("NOT_FINITE", Status::kNotFinite, "A number is not finite.")
      .finalize();
  m.def("failed", &failed, py::arg("status"), "Whether there is no result.");
  m.def("message", &message, py::arg("status"), "One sentence: what happened.");
  m.def("advice", &advice, py::arg("status"), "One sentence: what to do about it; empty for OK.");

  py::class_<PyScheme>(m, "Scheme", "A redundancy resolution scheme: what all of them can do.")
      .def_property_readonly(
          "level", [](const PyScheme& s) { return s.level() == Level::kVelocity ? "velocity" : "acceleration"; },
          "'velocity' where resolve returns qd, 'acceleration' where it returns qdd.")
      .def("resolve", &resolve_for_arm, py::arg("arm"), py::arg("q"), py::arg("qd"), py::arg("x"), py::arg("xd"),
           py::arg("xdd") = py::none(), py::kw_only(), py::arg("task") = "position",
           R"(Joint motion that the scheme asks for in one state.

Parameters
----------
arm : Arm
    The arm.
q, qd : array_like, shape (n,)
    Joint state [rad], [rad/s].
x : array_like, shape (2,), (3,) or (4, 4)
    Where the tip is to be in the base frame [m]; a pose is (x, y, angle) in the plane, a homogeneous matrix in space.
xd, xdd : array_like, shape (m,)
    Its velocity and acceleration, linear rows first, then angular [m/s, rad/s]; xdd may be left out at velocity level.
task : str
    'position' or 'pose'.

Returns
-------
numpy.ndarray, shape (n,)
    qd [rad/s] at velocity level, qdd [rad/s^2] at acceleration level.

Raises
------
ValueError
    Where an argument is not finite or of the wrong shape.
ResolutionError
    Where the posture is singular or the result not finite.)")
      .def("resolve", &resolve_for_kinematics, py::arg("kinematics"), py::arg("q"), py::arg("qd"), py::arg("x"),
           py::arg("xd"), py::arg("xdd") = py::none(),
           "The same for an arm whose tip, J and Jd you have from elsewhere, as a Kinematics.")
      .def("__reduce__", &reduce<PyScheme>)
      .def("__repr__", [](const PyScheme& scheme) { return scheme.repr; });

  bind_second_tasks(m);
  bind_velocity_schemes(m);
  bind_acceleration_schemes(m);
}

}  // namespace fpbm::bindings
