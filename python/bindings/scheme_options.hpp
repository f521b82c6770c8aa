#pragma once

#include <optional>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "scheme.hpp"
#include "text.hpp"

/// What the constructors of Python's schemes share: options, their checks, and what is said about them.
namespace fpbm::bindings {

using Law = PyScheme::Law;

/// Weights as a vector of n or a matrix of n x n; the library's own constructors check them.
inline void set_weights(PyScheme& scheme, const ArrayLike& weights) {
  const auto any = py::array::ensure(weights);
  if (any && any.ndim() == 2) {
    const PyScheme::Dense W = joint_matrix(weights, "weights");
    (void)DenseWeights<Eigen::Dynamic>(W);
    scheme.weights = W;
    scheme.repr += "weights=" + text(W);
  } else {
    PyErr_Clear();
    const PyScheme::Diagonal w = joint_vector(weights, "weights");
    (void)DiagonalWeights<Eigen::Dynamic>(w);
    scheme.weights = w;
    scheme.repr += "weights=" + text(w);
  }
}

/// Python's two kinds of second task.
struct PyPointTask : PySecondTask {};
struct PyGaze : PySecondTask {};
using OptionalTask = std::optional<std::variant<PyPointTask, PyGaze>>;

inline std::optional<PySecondTask> task_of(const OptionalTask& given) {
  if (!given) return std::nullopt;
  return std::visit([](const PySecondTask& task) { return task; }, *given);
}

/// What all schemes' constructors share.
struct Options {
  double null_damping = 0.0;
  OptionalArray rest_posture = std::nullopt;
  double null_stiffness = 0.0;
  OptionalArray c = std::nullopt;
  double joint_centring = 0.0;
  double manipulability_gain = 0.0;
  OptionalTask second_task = std::nullopt;
  double singular_radius = 0.0;
  double singular_brake = 10.0;
};

/// The shared options and the closing of repr; a trial visit checks all parameters against each other.
inline PyScheme finish(PyScheme scheme, const Options& options) {
  const auto note = [&scheme](const std::string& option) {
    if (scheme.repr.back() != '(') scheme.repr += ", ";
    scheme.repr += option;
  };
  Eigen::Index dof = 0;
  if (const auto* w = std::get_if<PyScheme::Diagonal>(&scheme.weights)) dof = w->size();
  if (const auto* W = std::get_if<PyScheme::Dense>(&scheme.weights)) dof = W->rows();
  const auto number = [&note](double& target, double value, const char* name) {
    target = value;
    if (value != 0.0) note(std::string(name) + "=" + text(value));
  };
  number(scheme.null_damping, options.null_damping, "null_damping");
  scheme.null_stiffness = options.null_stiffness;
  if (options.rest_posture) {
    scheme.rest_posture = joint_vector(*options.rest_posture, "rest_posture");
    if (dof == 0) dof = scheme.rest_posture->size();
    note("rest_posture=" + text(*scheme.rest_posture) + ", null_stiffness=" + text(options.null_stiffness));
  }
  if (options.c) {
    scheme.c = joint_vector(*options.c, "c");
    if (dof == 0) dof = scheme.c->size();
    note("c=" + text(*scheme.c));
  }
  number(scheme.joint_centring, options.joint_centring, "joint_centring");
  validation::require_non_negative("manipulability_gain", options.manipulability_gain);
  number(scheme.manipulability_gain, options.manipulability_gain, "manipulability_gain");
  scheme.second_task = task_of(options.second_task);
  if (scheme.second_task) note("second_task=" + scheme.second_task->repr);
  scheme.singular = SingularDamping<>(options.singular_radius, options.singular_brake);
  if (options.singular_radius != 0.0) {
    note("singular_radius=" + text(options.singular_radius));
    if (options.singular_brake != Options().singular_brake) note("singular_brake=" + text(options.singular_brake));
  }
  scheme.repr += ")";
  scheme.visit_core<Eigen::Dynamic>(JointLimits<Eigen::Dynamic>::none(dof == 0 ? 2 : dof), [](const auto&) {});
  return scheme;
}

inline PyScheme begin(Law law, const std::string& name) {
  PyScheme scheme{law};
  scheme.repr = name + "(";
  return scheme;
}

inline void set_gain(PyScheme& scheme, double k) {
  scheme.k = k;
  if (k != 0.0) scheme.repr += (scheme.repr.back() == '(' ? "k=" : ", k=") + text(k);
}

constexpr const char* kVelocityOptions = R"(
k : float
    Position feedback gain [1/s]: xd + k (x - f(q)) in place of xd.
rest_posture, null_stiffness : array_like, shape (n,), and float
    Posture [rad] that the null space is drawn to, and how strongly [1/s].
c : array_like, shape (n,)
    The free choice in the general solution (3) [rad/s].
joint_centring : float
    Gain [rad^2/s] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
    arm's limits bound both ways (Liegeois, 1977).
manipulability_gain : float
    Gain [rad^2/s] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985).
second_task : SecondTask or Gaze
    What the null space does before all else: the rest of these options have what it leaves.
singular_radius, singular_brake : float
    Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
    none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
and cannot be resolved from a Kinematics.

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
joint_centring : float
    Gain [rad^2/s^2] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
    arm's limits bound both ways (Liegeois, 1977).
manipulability_gain : float
    Gain [rad^2/s^2] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985). Wants
    null_damping, without which it swings for ever.
second_task : SecondTask or Gaze
    What the null space does before all else: the rest of these options have what it leaves.
singular_radius, singular_brake : float
    Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
    none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
and cannot be resolved from a Kinematics.

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

}  // namespace fpbm::bindings
