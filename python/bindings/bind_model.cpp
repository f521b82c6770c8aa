#include <limits>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "py_arm.hpp"
#include "text.hpp"

namespace fpbm::bindings {
namespace {

struct JointLimits {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  Eigen::VectorXd velocity;
  Eigen::VectorXd acceleration;

  static JointLimits none(int dof) {
    const Eigen::VectorXd infinite = Eigen::VectorXd::Constant(dof, std::numeric_limits<double>::infinity());
    return {-infinite, infinite, infinite, infinite};
  }
};

std::vector<std::string> joint_names(int dof) {
  std::vector<std::string> names;
  for (int i = 1; i <= dof; ++i) names.push_back("joint_" + std::to_string(i));
  return names;
}

Kinematics<Position<2>, kDynamic> kinematics(const PyPlanarArm& arm, const ArrayLike& q, const ArrayLike& qd,
                                             const std::string& task) {
  PyPlanarArm::require_task(task);
  const ArmModel::Joints positions = joint_vector(q, "q", arm.dof());
  return arm.model().kinematics(positions, joint_vector(qd, "qd", arm.dof()));
}

}  // namespace

void bind_model(py::module_& m) {
  m.attr("MAX_DOF") = kMaxDof;

  py::class_<JointLimits>(m, "JointLimits", "Bounds of each joint's motion, infinite where there is none.")
      .def_readonly("lower", &JointLimits::lower, "Lowest joint positions [rad], shape (n,).")
      .def_readonly("upper", &JointLimits::upper, "Highest joint positions [rad], shape (n,).")
      .def_readonly("velocity", &JointLimits::velocity, "Highest joint speeds [rad/s], shape (n,).")
      .def_readonly("acceleration", &JointLimits::acceleration, "Highest joint accelerations [rad/s^2], shape (n,).")
      .def("__repr__", [](const JointLimits& limits) {
        return "JointLimits(lower=" + text(limits.lower) + ", upper=" + text(limits.upper) +
               ", velocity=" + text(limits.velocity) + ", acceleration=" + text(limits.acceleration) + ")";
      });

  py::class_<PyPlanarArm>(m, "PlanarArm", R"(Planar arm of n revolute joints.

f(q) = sum_i l_i (cos th_i, sin th_i) with th_i = q_1 + ... + q_i: joint angles are relative [rad], the first
from the base frame's x axis.

Parameters
----------
lengths : array_like, shape (n,)
    Link lengths [m], 2 to MAX_DOF of them, positive. Up to 10 joints run in code made for just that number.

Raises
------
ValueError
    Where a length is not positive and finite, or there are too few or too many.)")
      .def(py::init([](const ArrayLike& lengths) { return PyPlanarArm(joint_vector(lengths, "lengths")); }),
           py::arg("lengths"))
      .def_property_readonly("dof", &PyPlanarArm::dof, "Number of joints n.")
      .def_property_readonly(
          "lengths", [](const PyPlanarArm& arm) { return Eigen::VectorXd(arm.lengths()); },
          "Link lengths [m], shape (n,).")
      .def_property_readonly(
          "joint_names", [](const PyPlanarArm& arm) { return joint_names(arm.dof()); },
          "Names of the joints, from the base on.")
      .def_property_readonly(
          "limits", [](const PyPlanarArm& arm) { return JointLimits::none(arm.dof()); },
          "Joint limits: a planar arm has none.")
      .def(
          "forward",
          [](const PyPlanarArm& arm, const ArrayLike& q) {
            return Eigen::Vector2d(kinematics(arm, q, q, "position").tip);
          },
          py::arg("q"), "Tip position f(q) in the base frame [m], shape (2,). q: shape (n,) [rad].")
      .def(
          "jacobian",
          [](const PyPlanarArm& arm, const ArrayLike& q, const std::string& task) {
            return Eigen::MatrixXd(kinematics(arm, q, q, task).J);
          },
          py::arg("q"), py::kw_only(), py::arg("task") = "position",
          "Task Jacobian J(q), shape (2, n) [m/rad]: tip velocity is J qd. q: shape (n,) [rad].")
      .def(
          "jacobian_dot",
          [](const PyPlanarArm& arm, const ArrayLike& q, const ArrayLike& qd, const std::string& task) {
            return Eigen::MatrixXd(kinematics(arm, q, qd, task).Jd);
          },
          py::arg("q"), py::arg("qd"), py::kw_only(), py::arg("task") = "position",
          "dJ/dt along qd, shape (2, n): tip acceleration is J qdd + Jd qd. q, qd: shape (n,) [rad], [rad/s].")
      .def("__eq__",
           [](const PyPlanarArm& arm, const py::object& other) {
             return py::isinstance<PyPlanarArm>(other) && other.cast<const PyPlanarArm&>().lengths() == arm.lengths();
           })
      .def("__hash__", [](const PyPlanarArm& arm) { return py::hash(py::str(text(arm.lengths()))); })
      .def("__repr__", [](const PyPlanarArm& arm) { return "PlanarArm(" + text(arm.lengths()) + ")"; })
      .def(py::pickle([](const PyPlanarArm& arm) { return Eigen::VectorXd(arm.lengths()); },
                      [](const Eigen::VectorXd& lengths) { return PyPlanarArm(lengths); }));
}

}  // namespace fpbm::bindings
