#include <string>

#include "arrays.hpp"
#include "bindings.hpp"
#include "kinematics.hpp"
#include "py_arm.hpp"
#include "text.hpp"

#include <pybind11/native_enum.h>

namespace fpbm::bindings {
namespace {

using Law = PyScheme::Law;

/// Weights as a vector of n or a matrix of n x n; the library's own constructors check them.
void set_weights(PyScheme& scheme, const ArrayLike& weights) {
  const auto any = py::array::ensure(weights);
  if (any && any.ndim() == 2) {
    const PyScheme::Dense W = joint_matrix(weights, "weights");
    (void)DenseWeights<kDynamic>(W);
    scheme.weights = W;
    scheme.repr += "weights=" + text(W);
  } else {
    PyErr_Clear();
    const PyScheme::Diagonal w = joint_vector(weights, "weights");
    (void)DiagonalWeights<kDynamic>(w);
    scheme.weights = w;
    scheme.repr += "weights=" + text(w);
  }
}

/// The null-space options and the closing of repr; a trial visit checks all parameters against each other.
PyScheme finish(PyScheme scheme, double null_damping, const OptionalArray& rest_posture, double null_stiffness,
                const OptionalArray& c) {
  const auto note = [&scheme](const std::string& option) {
    if (scheme.repr.back() != '(') scheme.repr += ", ";
    scheme.repr += option;
  };
  Eigen::Index dof = 0;
  if (const auto* w = std::get_if<PyScheme::Diagonal>(&scheme.weights)) dof = w->size();
  if (const auto* W = std::get_if<PyScheme::Dense>(&scheme.weights)) dof = W->rows();
  scheme.null_damping = null_damping;
  if (null_damping != 0.0) note("null_damping=" + text(null_damping));
  scheme.null_stiffness = null_stiffness;
  if (rest_posture) {
    scheme.rest_posture = joint_vector(*rest_posture, "rest_posture");
    if (dof == 0) dof = scheme.rest_posture->size();
    note("rest_posture=" + text(*scheme.rest_posture) + ", null_stiffness=" + text(null_stiffness));
  }
  if (c) {
    scheme.c = joint_vector(*c, "c");
    if (dof == 0) dof = scheme.c->size();
    note("c=" + text(*scheme.c));
  }
  scheme.repr += ")";
  const int any_dof = dof == 0 ? 2 : static_cast<int>(dof);
  scheme.visit<kDynamic>(any_dof, [](const auto&) {});
  return scheme;
}

PyScheme begin(Law law, const std::string& name) {
  PyScheme scheme{law};
  scheme.repr = name + "(";
  return scheme;
}

void set_gain(PyScheme& scheme, double k) {
  scheme.k = k;
  if (k != 0.0) scheme.repr += (scheme.repr.back() == '(' ? "k=" : ", k=") + text(k);
}

[[noreturn]] void raise(Status status) {
  const py::object type = py::module_::import("fpbm_cpp._errors").attr("ResolutionError");
  PyErr_SetObject(type.ptr(), type(py::cast(status)).ptr());
  throw py::error_already_set();
}

/// One evaluation in a task space, where the kinematics are known.
template <typename Space>
Eigen::VectorXd resolve_task(const PyScheme& scheme, const Kinematics<Space, kDynamic>& kinematics,
                             const State<kDynamic>& state, const ArrayLike& x, const ArrayLike& xd,
                             const OptionalArray& xdd) {
  constexpr int kRows = Space::kRows;
  require_redundant(kRows, static_cast<int>(state.q.size()));
  Reference<Space> reference{point<Space>(x, "x"), fixed_vector<kRows>(xd, "xd"), Vector<kRows>::Zero()};
  if (xdd) {
    reference.xdd = fixed_vector<kRows>(*xdd, "xdd");
  } else if (scheme.level() == Level::kAcceleration) {
    throw std::invalid_argument("xdd: an acceleration-level scheme needs it");
  }
  Joints out = Joints::Zero(state.q.size());
  const Status status = resolve(scheme, kinematics, reference, state, out);
  if (status != Status::kOk) raise(status);
  return out;
}

Eigen::VectorXd resolve_for_arm(const PyScheme& scheme, const PyArm& arm, const ArrayLike& q, const ArrayLike& qd,
                                const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd,
                                const std::string& task) {
  const State<kDynamic> state{joint_vector(q, "q", arm.dof()), joint_vector(qd, "qd", arm.dof())};
  return arm.visit(task, [&](const auto& model) {
    return resolve_task(scheme, model.kinematics(state.q, state.qd), state, x, xd, xdd);
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
        return resolve_task(scheme, known, state, x, xd, xdd);
      },
      kinematics.value);
}

constexpr const char* kVelocityOptions = R"(
k : float
    Position feedback gain [1/s]: xd + k (x - f(q)) in place of xd.
rest_posture, null_stiffness : array_like, shape (n,), and float
    Posture [rad] that the null space is drawn to, and how strongly [1/s].
c : array_like, shape (n,)
    The free choice in the general solution (3) [rad/s].

Raises
------
ValueError
    Where a parameter is out of range, not finite, or of the wrong shape.)";

constexpr const char* kAccelerationOptions = R"(
null_damping : float
    Damping of the self-motion [1/s], which nothing in the paper's schemes damps.
rest_posture, null_stiffness : array_like, shape (n,), and float
    Posture [rad] that the null space is drawn to, and how strongly [1/s^2].
c : array_like, shape (n,)
    The free choice in the general solution (5) [rad/s^2].

Raises
------
ValueError
    Where a parameter is out of range, not finite, or of the wrong shape.)";

constexpr const char* kWeightsText = R"(
weights : array_like, shape (n,) or (n, n)
    Diagonal of W, all positive, or W itself, symmetric positive definite. Only ratios matter.)";

constexpr const char* kAlphaText = R"(
alpha : float
    Share of WMVN, in [0, 1]; MAN has the rest.)";

constexpr const char* kParameters = "\n\nParameters\n----------";

}  // namespace

void bind_resolver(py::module_& m) {
  py::native_enum<Status>(m, "Status", "enum.Enum", "What became of an evaluation or a rollout.")
      .value("OK", Status::kOk, "The motion is complete.")
      .value("SINGULAR", Status::kSingular, "The posture is singular.")
      .value("TASK_LOST", Status::kTaskLost, "The tip has left its reference.")
      .value("NOT_FINITE", Status::kNotFinite, "A number is not finite.")
      .finalize();
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
      .def("__repr__", [](const PyScheme& scheme) { return scheme.repr; });

  struct PyMVN : PyScheme {};
  py::class_<PyMVN, PyScheme>(m, "MVN",
                              (std::string("Minimum velocity norm, (6): qd = J+ xd; with c the general solution (3).") +
                               kParameters + kVelocityOptions)
                                  .c_str())
      .def(py::init([](double k, const OptionalArray& rest, double stiffness, const OptionalArray& c) {
             PyScheme scheme = begin(Law::kWMVN, "MVN");
             set_gain(scheme, k);
             return PyMVN{finish(scheme, 0.0, rest, stiffness, c)};
           }),
           py::kw_only(), py::arg("k") = 0.0, py::arg("rest_posture") = py::none(), py::arg("null_stiffness") = 0.0,
           py::arg("c") = py::none());

  struct PyWMVN : PyScheme {};
  py::class_<PyWMVN, PyScheme>(m, "WMVN",
                               (std::string("Weighted minimum velocity norm, (7): qd = J_W+ xd, of least qd' W qd.") +
                                kParameters + kWeightsText + kVelocityOptions)
                                   .c_str())
      .def(py::init([](const ArrayLike& weights, double k, const OptionalArray& rest, double stiffness,
                       const OptionalArray& c) {
             PyScheme scheme = begin(Law::kWMVN, "WMVN");
             set_weights(scheme, weights);
             set_gain(scheme, k);
             return PyWMVN{finish(scheme, 0.0, rest, stiffness, c)};
           }),
           py::arg("weights"), py::kw_only(), py::arg("k") = 0.0, py::arg("rest_posture") = py::none(),
           py::arg("null_stiffness") = 0.0, py::arg("c") = py::none());

  struct PyMAN : PyScheme {};
  py::class_<PyMAN, PyScheme>(
      m, "MAN",
      (std::string("Minimum acceleration norm, (8): qdd = J+ (xdd - Jd qd); with c the general solution (5).") +
       kParameters + kAccelerationOptions)
          .c_str())
      .def(py::init([](double damping, const OptionalArray& rest, double stiffness, const OptionalArray& c) {
             return PyMAN{finish(begin(Law::kMAN, "MAN"), damping, rest, stiffness, c)};
           }),
           py::kw_only(), py::arg("null_damping") = 0.0, py::arg("rest_posture") = py::none(),
           py::arg("null_stiffness") = 0.0, py::arg("c") = py::none());

  struct PyWMVNAcceleration : PyScheme {};
  py::class_<PyWMVNAcceleration, PyScheme>(
      m, "WMVNAcceleration",
      (std::string("Weighted minimum velocity norm at acceleration level, (9), which is (7) differentiated.\n\n"
                   "qdd = J_W+ (xdd - Jd qd) + N_W W^-1 Jd' (J W^-1 J')^-1 xd.") +
       kParameters + kWeightsText + kAccelerationOptions)
          .c_str())
      .def(py::init([](const ArrayLike& weights, double damping, const OptionalArray& rest, double stiffness,
                       const OptionalArray& c) {
             PyScheme scheme = begin(Law::kFPBM, "WMVNAcceleration");
             scheme.alpha = 1.0;
             set_weights(scheme, weights);
             return PyWMVNAcceleration{finish(scheme, damping, rest, stiffness, c)};
           }),
           py::arg("weights"), py::kw_only(), py::arg("null_damping") = 0.0, py::arg("rest_posture") = py::none(),
           py::arg("null_stiffness") = 0.0, py::arg("c") = py::none());

  struct PyBalanced : PyScheme {};
  py::class_<PyBalanced, PyScheme>(
      m, "Balanced",
      (std::string("Balance of MAN and WMVN without feedback, (16): (1 - alpha) MAN (8) + alpha WMVN (9).") +
       kParameters + kAlphaText + kWeightsText + kAccelerationOptions)
          .c_str())
      .def(py::init([](double alpha, const ArrayLike& weights, double damping, const OptionalArray& rest,
                       double stiffness, const OptionalArray& c) {
             PyScheme scheme = begin(Law::kFPBM, "Balanced");
             scheme.alpha = alpha;
             scheme.repr += "alpha=" + text(alpha) + ", ";
             set_weights(scheme, weights);
             return PyBalanced{finish(scheme, damping, rest, stiffness, c)};
           }),
           py::arg("alpha"), py::arg("weights"), py::kw_only(), py::arg("null_damping") = 0.0,
           py::arg("rest_posture") = py::none(), py::arg("null_stiffness") = 0.0, py::arg("c") = py::none());

  struct PyFPBM : PyScheme {};
  py::class_<PyFPBM, PyScheme>(
      m, "FPBM",
      (std::string(
           "Feedback-added pseudoinverse-type balanced minimisation, (13).\n\n"
           "The balance (16) with b = xdd - Jd qd + k1 (xd - J qd) + k2 (x - f(q)) in place of xdd - Jd qd, so\n"
           "that the tip error e obeys e'' + k1 e' + k2 e = 0 whatever alpha and W.") +
       kParameters + kAlphaText + kWeightsText +
       "\nk1, k2 : float\n    Feedback gains on velocity [1/s] and position [1/s^2], not negative." +
       kAccelerationOptions)
          .c_str())
      .def(py::init([](double alpha, const ArrayLike& weights, double k1, double k2, double damping,
                       const OptionalArray& rest, double stiffness, const OptionalArray& c) {
             PyScheme scheme = begin(Law::kFPBM, "FPBM");
             scheme.alpha = alpha;
             scheme.k1 = k1;
             scheme.k2 = k2;
             scheme.repr += "alpha=" + text(alpha) + ", ";
             set_weights(scheme, weights);
             scheme.repr += ", k1=" + text(k1) + ", k2=" + text(k2);
             return PyFPBM{finish(scheme, damping, rest, stiffness, c)};
           }),
           py::arg("alpha"), py::arg("weights"), py::arg("k1"), py::arg("k2"), py::kw_only(),
           py::arg("null_damping") = 0.0, py::arg("rest_posture") = py::none(), py::arg("null_stiffness") = 0.0,
           py::arg("c") = py::none());
}

}  // namespace fpbm::bindings
