#include <pybind11/typing.h>

#include <array>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fpbm/model/dh.hpp"
#include "fpbm/model/presets.hpp"
#include "kinematics.hpp"
#include "py_arm.hpp"
#include "text.hpp"

namespace fpbm::bindings {
namespace {

using Limits = JointLimits<kDynamic>;
constexpr std::array kTypes{"revolute", "continuous", "prismatic"};

JointType joint_type(const std::string& type, const std::string& name) {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (type == kTypes[i]) return static_cast<JointType>(i);
  }
  throw std::invalid_argument(name + " = '" + type + "': must be 'revolute', 'continuous' or 'prismatic'");
}

/// A chain of fpbm_cpp.Joint, or of anything with its attributes.
Chain<> chain_of(const py::typing::List<py::object>& joints, const ArrayLike& tip) {
  Chain<> chain;
  for (const py::handle given : joints) {
    const std::string name = "joints[" + std::to_string(chain.joints.size()) + "]";
    const auto number = [&](const char* attribute) { return py::cast<double>(given.attr(attribute)); };
    const auto array = [&](const char* attribute) { return ArrayLike(py::object(given.attr(attribute))); };
    Joint<> joint;
    joint.type = joint_type(py::cast<std::string>(given.attr("type")), name + ".type");
    joint.placement = transform(array("placement"), (name + ".placement").c_str());
    joint.axis = fixed_vector<3>(array("axis"), (name + ".axis").c_str());
    joint.bounds = {number("lower"), number("upper"), number("velocity"), number("acceleration")};
    joint.name = py::cast<std::string>(given.attr("name"));
    if (const py::object mimic = given.attr("mimic"); !mimic.is_none()) {
      const auto [index, ratio, offset] = py::cast<std::tuple<int, double, double>>(mimic);
      if (index < 0) validation::fail(name + ".mimic[0]", index, "the index of a joint");
      joint.mimic = {index, ratio, offset};
    }
    chain.joints.push_back(joint);
  }
  chain.tip = transform(tip, "tip");
  return chain;
}

Limits limits_of(const ArrayLike& lower, const ArrayLike& upper, const ArrayLike& velocity,
                 const ArrayLike& acceleration) {
  const Joints first = joint_vector(lower, "lower");
  const auto bound = [&first](const ArrayLike& given, const char* name) {
    const Joints values = joint_vector(given, name);
    validation::require_size(name, values.size(), first.size());
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (std::isnan(values(i))) validation::fail(validation::element(name, i), values(i), "a number");
    }
    return values;
  };
  return {bound(lower, "lower"), bound(upper, "upper"), bound(velocity, "velocity"),
          bound(acceleration, "acceleration")};
}

using PlainChain = py::typing::Tuple<py::typing::List<py::typing::Dict<py::str, py::object>>, py::array_t<double>>;

/// A chain as Python makes its joints from: a dictionary for each, and the tip.
PlainChain plain(const Chain<>& chain) {
  py::list joints;
  for (const Joint<>& joint : chain.joints) {
    py::typing::Dict<py::str, py::object> fields;
    fields["type"] = kTypes[static_cast<std::size_t>(joint.type)];
    fields["placement"] = array_of(joint.placement);
    fields["axis"] = array_of(joint.axis);
    fields["lower"] = joint.bounds.lower;
    fields["upper"] = joint.bounds.upper;
    fields["velocity"] = joint.bounds.velocity;
    fields["acceleration"] = joint.bounds.acceleration;
    fields["name"] = joint.name;
    joints.append(fields);
  }
  return py::make_tuple(joints, array_of(chain.tip));
}

/// The chain of a Denavit-Hartenberg table, one row (a, alpha, d, theta) a joint.
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
  throw std::invalid_argument("convention = '" + convention + "': must be 'classic' or 'modified'");
}

PlainChain preset(const std::string& name) {
  if (name == "panda") return plain(presets::panda());
  if (name == "iiwa14") return plain(presets::iiwa14());
  if (name == "gen3") return plain(presets::gen3());
  throw std::invalid_argument("name = '" + name + "': must be 'panda', 'iiwa14' or 'gen3'");
}

PyKinematics kinematics_of(const PyArm& arm, const ArrayLike& q, const ArrayLike& qd, const std::string& task) {
  const Joints positions = joint_vector(q, "q", arm.dof());
  const Joints velocities = joint_vector(qd, "qd", arm.dof());
  return arm.visit(task, [&](const auto& model) { return PyKinematics{model.kinematics(positions, velocities)}; });
}

template <typename Space>
PyKinematics given(const ArrayLike& tip, const ArrayLike& J, const OptionalArray& Jd) {
  const auto dof = real_array(J, "J", 2).shape(1);
  validation::require_dof("a row of J", dof, 1);
  Kinematics<Space, kDynamic> known;
  known.tip = point<Space>(tip, "tip");
  known.J = matrix(J, "J", Space::kRows, dof);
  known.Jd.setZero(Space::kRows, dof);
  if (Jd) known.Jd = matrix(*Jd, "Jd", Space::kRows, dof);
  return {known, Jd.has_value()};
}

/// The task space goes by the shape of tip, with three numbers by the task as well.
PyKinematics make_kinematics(const ArrayLike& tip, const ArrayLike& J, const OptionalArray& Jd,
                             const std::string& task) {
  if (task != "position" && task != "pose") {
    throw std::invalid_argument("task = '" + task + "': must be 'position' or 'pose'");
  }
  const auto shape = py::array::ensure(tip);
  PyErr_Clear();
  if (shape && shape.ndim() == 2) return given<Pose>(tip, J, Jd);
  if (shape && shape.size() == 2) return given<Position<2>>(tip, J, Jd);
  return task == "pose" ? given<PlanarPose>(tip, J, Jd) : given<Position<3>>(tip, J, Jd);
}

constexpr const char* kTaskText = R"( task: 'position' or 'pose', whose rows are linear first, then
angular, along the base frame's axes.)";

}  // namespace

void bind_model(py::module_& m) {
  m.attr("MAX_DOF") = kMaxDof;

  py::class_<Limits>(m, "JointLimits", R"(Bounds of each joint's motion, infinite where there is none.

Parameters
----------
lower, upper, velocity, acceleration : array_like, shape (n,)
    Bounds on positions [rad], velocities either way [rad/s] and accelerations either way [rad/s^2]; [m] and so on for
    prismatic joints.

Raises
------
ValueError
    Where one is not a number, or has another length.)")
      .def(py::init(&limits_of), py::kw_only(), py::arg("lower"), py::arg("upper"), py::arg("velocity"),
           py::arg("acceleration"))
      .def_property_readonly(
          "lower", [](const Limits& limits) { return Eigen::VectorXd(limits.lower); },
          "Lowest joint positions [rad] or [m], shape (n,).")
      .def_property_readonly(
          "upper", [](const Limits& limits) { return Eigen::VectorXd(limits.upper); },
          "Highest joint positions [rad] or [m], shape (n,).")
      .def_property_readonly(
          "velocity", [](const Limits& limits) { return Eigen::VectorXd(limits.velocity); },
          "Highest joint speeds [rad/s] or [m/s], shape (n,).")
      .def_property_readonly(
          "acceleration", [](const Limits& limits) { return Eigen::VectorXd(limits.acceleration); },
          "Highest joint accelerations [rad/s^2] or [m/s^2], shape (n,).")
      .def("__repr__", [](const Limits& limits) {
        return "JointLimits(lower=" + text(limits.lower) + ", upper=" + text(limits.upper) +
               ", velocity=" + text(limits.velocity) + ", acceleration=" + text(limits.acceleration) + ")";
      });

  py::class_<PyKinematics>(m, "Kinematics", R"(Tip, J and Jd of an arm in one state: all that a scheme knows of it.

From an arm's kinematics(), or from any library that has these three (Pinocchio, Drake, MuJoCo, ...).

Parameters
----------
tip : array_like, shape (2,), (3,) or (4, 4)
    f(q) in the base frame [m]: a position, (x, y, angle) of a pose in the plane, or a homogeneous matrix.
J : array_like, shape (m, n)
    Task Jacobian, linear rows first, then angular, along the base frame's axes (Pinocchio's LOCAL_WORLD_ALIGNED).
Jd : array_like, shape (m, n), optional
    dJ/dt along qd; velocity-level schemes do without.
task : str
    Tells what three numbers in tip are: a 'position' in space, or a 'pose' in the plane.

Raises
------
ValueError
    Where a number is not finite, or shapes do not fit.)")
      .def(py::init(&make_kinematics), py::arg("tip"), py::arg("J"), py::arg("Jd") = py::none(), py::kw_only(),
           py::arg("task") = "position")
      .def_property_readonly(
          "tip",
          [](const PyKinematics& kinematics) {
            return std::visit([](const auto& known) { return array_of(known.tip); }, kinematics.value);
          },
          "f(q) in the base frame [m], shape (2,), (3,) or (4, 4).")
      .def_property_readonly(
          "J",
          [](const PyKinematics& kinematics) {
            return std::visit([](const auto& known) { return Eigen::MatrixXd(known.J); }, kinematics.value);
          },
          "Task Jacobian, shape (m, n).")
      .def_property_readonly(
          "Jd",
          [](const PyKinematics& kinematics) {
            return std::visit([](const auto& known) { return Eigen::MatrixXd(known.Jd); }, kinematics.value);
          },
          "dJ/dt along qd, shape (m, n).");

  py::class_<PyArm>(m, "Arm", "A robot arm: what all kinds of it can do.")
      .def_property_readonly("dof", &PyArm::dof, "Number of joints n.")
      .def_property_readonly("limits", &PyArm::limits, "Bounds of the joints' motion.")
      .def_property_readonly("joint_names", &PyArm::joint_names, "Names of the joints, from the base on.")
      .def("kinematics", &kinematics_of, py::arg("q"), py::arg("qd"), py::kw_only(), py::arg("task") = "position",
           (std::string("Tip, J and Jd at q, qd, shape (n,) [rad], [rad/s].") + kTaskText).c_str())
      .def(
          "jacobian",
          [](const PyArm& arm, const ArrayLike& q, const std::string& task) {
            const PyKinematics known = kinematics_of(arm, q, q, task);
            return std::visit([](const auto& k) { return Eigen::MatrixXd(k.J); }, known.value);
          },
          py::arg("q"), py::kw_only(), py::arg("task") = "position",
          (std::string("Task Jacobian J(q), shape (m, n): tip velocity is J qd. q: shape (n,) [rad].") + kTaskText)
              .c_str())
      .def(
          "jacobian_dot",
          [](const PyArm& arm, const ArrayLike& q, const ArrayLike& qd, const std::string& task) {
            const PyKinematics known = kinematics_of(arm, q, qd, task);
            return std::visit([](const auto& k) { return Eigen::MatrixXd(k.Jd); }, known.value);
          },
          py::arg("q"), py::arg("qd"), py::kw_only(), py::arg("task") = "position",
          (std::string(
               "dJ/dt along qd, shape (m, n): tip acceleration is J qdd + Jd qd. q, qd: shape (n,) [rad], [rad/s].") +
           kTaskText)
              .c_str());

  py::class_<PyPlanarArm, PyArm>(m, "PlanarArm", R"(Planar arm of n revolute joints.

f(q) = sum_i l_i (cos th_i, sin th_i) with th_i = q_1 + ... + q_i: joint angles are relative [rad], the first
from the base frame's x axis. Its pose is (x, y, th_n).

Parameters
----------
lengths : array_like, shape (n,)
    Link lengths [m], 2 to MAX_DOF of them, positive. Up to 8 joints run in code made for just that number.

Raises
------
ValueError
    Where a length is not positive and finite, or there are too few or too many.)")
      .def(py::init([](const ArrayLike& lengths) { return PyPlanarArm(joint_vector(lengths, "lengths")); }),
           py::arg("lengths"))
      .def_property_readonly(
          "lengths", [](const PyPlanarArm& arm) { return Eigen::VectorXd(arm.lengths()); },
          "Link lengths [m], shape (n,).")
      .def(
          "forward",
          [](const PyPlanarArm& arm, const ArrayLike& q) {
            return std::visit([](const auto& k) -> py::array_t<double> { return array_of(k.tip); },
                              kinematics_of(arm, q, q, "position").value);
          },
          py::arg("q"), "Tip position f(q) in the base frame [m], shape (2,). q: shape (n,) [rad].")
      .def("__eq__",
           [](const PyPlanarArm& arm, const py::object& other) {
             return py::isinstance<PyPlanarArm>(other) && other.cast<const PyPlanarArm&>().lengths() == arm.lengths();
           })
      .def("__hash__", [](const PyPlanarArm& arm) { return py::hash(py::str(text(arm.lengths()))); })
      .def("__repr__", [](const PyPlanarArm& arm) { return "PlanarArm(" + text(arm.lengths()) + ")"; })
      .def(py::pickle([](const PyPlanarArm& arm) { return Eigen::VectorXd(arm.lengths()); },
                      [](const Eigen::VectorXd& lengths) { return PyPlanarArm(lengths); }));

  py::class_<PySerialArm, PyArm>(m, "SerialArm", "The compiled part of fpbm_cpp.SerialArm.")
      .def(py::init([](const py::typing::List<py::object>& joints, const ArrayLike& tip) {
             return PySerialArm(chain_of(joints, tip));
           }),
           py::arg("joints"), py::arg("tip"))
      .def(
          "forward",
          [](const PySerialArm& arm, const ArrayLike& q) {
            return std::visit([](const auto& k) -> py::array_t<double> { return array_of(k.tip); },
                              kinematics_of(arm, q, q, "pose").value);
          },
          py::arg("q"),
          "Tip pose f(q) in the base frame as a homogeneous matrix [m], shape (4, 4). q: shape (n,) [rad].");
  m.def("dh", &dh, py::arg("table"), py::arg("convention"), py::arg("types"));
  m.def("preset", &preset, py::arg("name"));
  m.def(
      "rotation_vector",
      [](const ArrayLike& R) { return Eigen::Vector3d(rotation_vector(Matrix<3, 3>(matrix(R, "R", 3, 3)))); },
      py::arg("R"), "Rotation vector of a rotation matrix, shape (3,), of length at most pi [rad].");
  m.def(
      "rotation", [](const ArrayLike& r) { return Eigen::Matrix3d(rotation(fixed_vector<3>(r, "r"))); }, py::arg("r"),
      "Rotation matrix, shape (3, 3), of a rotation vector r [rad]: by |r| about r/|r|.");
}

}  // namespace fpbm::bindings
