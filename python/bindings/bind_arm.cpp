#include <pybind11/typing.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "arm.hpp"
#include "arrays.hpp"
#include "fpbm/model/dh.hpp"
#include "fpbm/model/presets.hpp"
#include "joints.hpp"

namespace fpbm::bindings {
namespace {

/// A chain from objects with the attributes of fpbm_cpp.Joint.
Chain<> chain_of(const py::typing::List<py::object>& joints, const ArrayLike& tip) {
  Chain<> chain;
  for (const py::handle given : joints) {
    const validation::Argument name = validation::element("joints", static_cast<Eigen::Index>(chain.joints.size()));
    chain.joints.push_back(joint_of_python(given, name));
  }
  chain.tip = transform(tip, "tip");
  return chain;
}

using PlainChain = py::typing::Tuple<py::typing::List<PlainJoint>, Array>;

/// A chain as plain data: the keyword arguments of fpbm_cpp.Joint for each joint, and the tip.
PlainChain plain(const Chain<>& chain) {
  py::list joints;
  for (const Joint<>& joint : chain.joints) joints.append(fields_of(joint));
  return py::make_tuple(joints, array_of(chain.tip));
}

/// The chain of a Denavit-Hartenberg table, one row (a, alpha, d, theta) per joint.
PlainChain dh(const ArrayLike& table, const std::string& convention, const std::vector<std::string>& types) {
  const auto rows = real_array(table, "table", 2).shape(0);
  const Eigen::MatrixXd numbers = matrix(table, "table", rows, 4);
  validation::require_size("types", static_cast<Eigen::Index>(types.size()), rows);
  std::vector<DHRow<>> parameters;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const JointType type = joint_type(types[static_cast<std::size_t>(i)], validation::element("types", i));
    parameters.push_back({numbers(i, 0), numbers(i, 1), numbers(i, 2), numbers(i, 3), type});
  }
  if (convention == "classic") return plain(classic_dh(parameters));
  if (convention == "modified") return plain(modified_dh(parameters));
  validation::reject("convention", " = '" + convention + "': must be 'classic' or 'modified'");
}

PlainChain preset(const std::string& name) {
  for (const presets::Preset& known : presets::kAll) {
    if (name == known.name) return plain(known.chain());
  }
  validation::reject("name", " = '" + name + "': must be one of PRESETS");
}

AnyKinematics kinematics_of(const Arm& arm, const ArrayLike& q, const ArrayLike& qd, const std::string& task) {
  const JointVector positions = joint_vector(q, "q", arm.dof());
  const JointVector velocities = joint_vector(qd, "qd", arm.dof());
  return arm.visit(task, [&](const auto& any, auto space) {
    Kinematics<decltype(space), kDynamic> result;
    any.kinematics(positions, velocities, result);
    return AnyKinematics{result};
  });
}

Array tip_of(const AnyKinematics& kinematics) {
  return std::visit([](const auto& known) { return array_of(known.tip); }, kinematics.value);
}
Array jacobian_of(const AnyKinematics& kinematics) {
  return std::visit([](const auto& known) { return array_of(known.J); }, kinematics.value);
}
Array rate_of(const AnyKinematics& kinematics) {
  return std::visit([](const auto& known) { return array_of(known.Jd); }, kinematics.value);
}

Array forward(const Arm& arm, const ArrayLike& q) {
  const bool planar = std::holds_alternative<AnyArm<Position<2>>>(arm.any);
  return tip_of(kinematics_of(arm, q, q, planar ? "position" : "pose"));
}

template <typename Space>
AnyKinematics given(const ArrayLike& tip, const ArrayLike& J, const OptionalArray& Jd) {
  const auto dof = real_array(J, "J", 2).shape(1);
  validation::require_dof("a row of J", dof, 1);
  Kinematics<Space, kDynamic> known;
  known.tip = point<Space>(tip, "tip");
  known.J = matrix(J, "J", Space::kRows, dof);
  known.Jd.setZero(Space::kRows, dof);
  if (Jd) known.Jd = matrix(*Jd, "Jd", Space::kRows, dof);
  return {known, Jd.has_value()};
}

/// The shape of tip determines the task space, for three numbers together with the task.
AnyKinematics make_kinematics(const ArrayLike& tip, const ArrayLike& J, const OptionalArray& Jd,
                              const std::string& task) {
  if (task != "position" && task != "pose") {
    validation::reject("task", " = '" + task + "': must be 'position' or 'pose'");
  }
  const auto shape = py::array::ensure(tip);
  PyErr_Clear();
  if (shape && shape.ndim() == 2) return given<Pose>(tip, J, Jd);
  if (shape && shape.size() == 2) return given<Position<2>>(tip, J, Jd);
  return task == "pose" ? given<PlanarPose>(tip, J, Jd) : given<Position<3>>(tip, J, Jd);
}

void bind_kinematics(py::module_& m) {
  py::class_<AnyKinematics>(m, "Kinematics", R"(Tip, J and Jd of an arm in one state: the input of a scheme.

From kinematics() of an arm, or from another library (Pinocchio, Drake, MuJoCo, ...).

Parameters
----------
tip : array_like, shape (2,), (3,) or (4, 4)
    f(q) in the base frame [m]: a position, (x, y, angle) of a pose in the plane, or a homogeneous matrix.
J : array_like, shape (m, n)
    Task Jacobian, linear rows first, then angular, along the base frame's axes (Pinocchio's LOCAL_WORLD_ALIGNED).
Jd : array_like, shape (m, n), optional
    dJ/dt along qd; not needed by velocity-level schemes.
task : str
    Meaning of three numbers in tip: a 'position' in space, or a 'pose' in the plane.

Raises
------
ParameterError
    If a number is not finite, or shapes do not match.)")
      .def(py::init(&make_kinematics), py::arg("tip"), py::arg("J"), py::arg("Jd") = py::none(), py::kw_only(),
           py::arg("task") = "position")
      .def_property_readonly("tip", &tip_of, "f(q) in the base frame [m], shape (2,), (3,) or (4, 4).")
      .def_property_readonly("J", &jacobian_of, "Task Jacobian, shape (m, n).")
      .def_property_readonly("Jd", &rate_of, "dJ/dt along qd, shape (m, n).");
}

}  // namespace

void bind_arm(py::module_& m) {
  py::tuple names(std::size(presets::kAll));
  for (std::size_t i = 0; i < std::size(presets::kAll); ++i) names[i] = presets::kAll[i].name;
  m.attr("PRESETS") = names;
  bind_kinematics(m);

  const auto task = py::arg("task") = "position";
  py::class_<Arm, Model>(m, "Arm", "The compiled part of an arm: planar, from link lengths, or in space, from joints.")
      .def(py::init([](const ArrayLike& lengths) { return Arm(joint_vector(lengths, "lengths")); }), py::arg("lengths"))
      .def(py::init([](const py::typing::List<py::object>& joints, const ArrayLike& tip) {
             return Arm(chain_of(joints, tip));
           }),
           py::arg("joints"), py::arg("tip"))
      .def("forward", &forward, py::arg("q"),
           "Tip f(q) in the base frame [m]: for a planar arm, a position, shape (2,); for an arm in space, a\n"
           "homogeneous matrix, shape (4, 4). q: shape (n,) [rad].")
      .def("kinematics", &kinematics_of, py::arg("q"), py::arg("qd"), py::kw_only(), task,
           "Tip, J and Jd of a task, 'position' or 'pose', at q, qd, shape (n,) [rad], [rad/s].")
      .def(
          "jacobian",
          [](const Arm& arm, const ArrayLike& q, const std::string& name) {
            return jacobian_of(kinematics_of(arm, q, q, name));
          },
          py::arg("q"), py::kw_only(), task,
          "Task Jacobian J(q), shape (m, n): the tip's velocity is J qd, linear rows first, then angular. q: (n,) "
          "[rad].")
      .def(
          "jacobian_dot",
          [](const Arm& arm, const ArrayLike& q, const ArrayLike& qd, const std::string& name) {
            return rate_of(kinematics_of(arm, q, qd, name));
          },
          py::arg("q"), py::arg("qd"), py::kw_only(), task,
          "dJ/dt along qd, shape (m, n): the tip's acceleration is J qdd + Jd qd. q, qd: (n,) [rad], [rad/s].");

  m.def("dh", &dh, py::arg("table"), py::arg("convention"), py::arg("types"));
  m.def("preset", &preset, py::arg("name"));
  m.def(
      "rotation_vector",
      [](const ArrayLike& R) { return array_of(rotation_vector(Matrix<3, 3>(matrix(R, "R", 3, 3)))); }, py::arg("R"),
      "Rotation vector of a rotation matrix, shape (3,), of length at most pi [rad].");
  m.def(
      "rotation", [](const ArrayLike& r) { return array_of(rotation(fixed_vector<3>(r, "r"))); }, py::arg("r"),
      "Rotation matrix, shape (3, 3), of a rotation vector r [rad]: by |r| about r/|r|.");
}

}  // namespace fpbm::bindings
