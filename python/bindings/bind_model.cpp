#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arm.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "fpbm/model/detail/center_of_mass.hpp"
#include "fpbm/model/detail/robot_presets.hpp"
#include "fpbm/model/dh.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/presets.hpp"

namespace fpbm::bindings {
namespace {

constexpr std::array kTypes{"revolute", "continuous", "prismatic"};

JointType joint_type(const std::string& type, const validation::Argument& name) {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (type == kTypes[i]) return static_cast<JointType>(i);
  }
  validation::reject(name, " = '" + type + "': must be 'revolute', 'continuous' or 'prismatic'");
}

/// A joint from an object with the attributes of fpbm_cpp.Joint.
Joint<> joint_of_python(const py::handle& given, const validation::Argument& name) {
  const auto number = [&](const char* attribute) { return py::cast<double>(given.attr(attribute)); };
  const auto array = [&](const char* attribute) { return ArrayLike(py::object(given.attr(attribute))); };
  Joint<> joint;
  joint.type = joint_type(py::cast<std::string>(given.attr("type")), name + ".type");
  joint.placement = transform(array("placement"), (name + ".placement").text().c_str());
  joint.axis = fixed_vector<3>(array("axis"), (name + ".axis").text().c_str());
  joint.bounds = {number("lower"), number("upper"),           number("velocity"),     number("acceleration"),
                  number("jerk"),  number("velocity_offset"), number("deceleration"), number("effort")};
  joint.name = py::cast<std::string>(given.attr("name"));
  joint.moved = {number("mass"), fixed_vector<3>(array("center"), (name + ".center").text().c_str()),
                 matrix<Matrix<3, 3>>(array("inertia"), (name + ".inertia").text().c_str(), 3, 3)};
  joint.drive = {number("rotor_inertia"), number("damping"), number("friction")};
  if (const py::object mimic = given.attr("mimic"); !mimic.is_none()) {
    const auto [index, ratio, offset] = py::cast<std::tuple<int, double, double>>(mimic);
    if (index < 0) validation::fail(name + ".mimic[0]", index, "the index of a joint");
    joint.mimic = {index, ratio, offset};
  }
  return joint;
}

using PlainJoint = py::typing::Dict<py::str, py::object>;

/// A joint as keyword arguments of fpbm_cpp.Joint.
PlainJoint fields_of(const Joint<>& joint) {
  PlainJoint fields;
  fields["type"] = kTypes[static_cast<std::size_t>(joint.type)];
  fields["placement"] = array_of(joint.placement);
  fields["axis"] = array_of(joint.axis);
  fields["lower"] = joint.bounds.lower;
  fields["upper"] = joint.bounds.upper;
  fields["velocity"] = joint.bounds.velocity;
  fields["acceleration"] = joint.bounds.acceleration;
  fields["jerk"] = joint.bounds.jerk;
  fields["velocity_offset"] = joint.bounds.velocity_offset;
  fields["deceleration"] = joint.bounds.deceleration;
  fields["effort"] = joint.bounds.effort;
  fields["mass"] = joint.moved.mass;
  fields["center"] = array_of(joint.moved.centre);
  fields["inertia"] = array_of(joint.moved.inertia);
  fields["rotor_inertia"] = joint.drive.rotor_inertia;
  fields["damping"] = joint.drive.viscous;
  fields["friction"] = joint.drive.dry;
  fields["name"] = joint.name;
  return fields;
}

using PlainTreeJoint = py::typing::Tuple<PlainJoint, py::int_>;
using PlainFrame = py::typing::Tuple<py::str, py::int_, Array>;

/// A separate class, from which the Robot of Python is derived.
struct PyRobot : Model {
  using Model::Model;
};

/// A tree from objects with the attributes of fpbm_cpp.TreeJoint and fpbm_cpp.NamedFrame.
Tree<> tree_of_python(const py::typing::List<py::object>& joints, const py::typing::List<py::object>& frames,
                      double base_mass, const ArrayLike& base_center) {
  Tree<> tree;
  tree.base = {base_mass, fixed_vector<3>(base_center, "base_center")};
  for (const py::handle each : joints) {
    const auto i = static_cast<Eigen::Index>(tree.joints.size());
    tree.joints.push_back(
        {joint_of_python(each.attr("joint"), validation::element("joints", i)), py::cast<int>(each.attr("parent"))});
  }
  for (const py::handle each : frames) {
    tree.frames.push_back({py::cast<std::string>(each.attr("name")), py::cast<int>(each.attr("link")),
                           transform(ArrayLike(py::object(each.attr("offset"))), "offset")});
  }
  return tree;
}

/// Frame, J and J̇ of a frame of a robot in one state.
struct FrameState {
  Transform<> at;
  Matrix<6, kDynamic> J;
  Matrix<6, kDynamic> Jd;

  FrameState(const Model& model, const ArrayLike& q, const ArrayLike& qd, const std::string& frame) {
    const auto [link, offset] = model.frame(frame);
    RobotState<kDynamic> state;
    model.robot.update(joint_vector(q, "q", model.dof()), joint_vector(qd, "qd", model.dof()), state);
    at = model.robot.frame(state, link, model.robot.in_joint(link, offset));
    model.robot.jacobian(state, link, at.p, J, Jd);
  }
};

using FrameOfLink = std::pair<int, Transform<>>;

/// Frames on links in postures q, one posture per row, shape (K, frames, 4, 4).
Array frames_in(const Model& model, const ArrayLike& q, const std::vector<FrameOfLink>& frames) {
  const auto rows = real_array(q, "q", 2);
  validation::require_size("a row of q", rows.shape(1), model.dof());
  Array result({rows.shape(0), static_cast<py::ssize_t>(frames.size()), py::ssize_t{4}, py::ssize_t{4}});
  double* out = result.mutable_data();
  RobotState<kDynamic> state;
  for (py::ssize_t k = 0; k < rows.shape(0); ++k) {
    model.robot.update(JointVector(Eigen::Map<const Eigen::VectorXd>(rows.data(k, 0), model.dof())), state);
    for (const auto& [link, offset] : frames) {
      Pose::store(model.robot.frame(state, link, model.robot.in_joint(link, offset)), out);
      out += Pose::kSize;
    }
  }
  return result;
}

Array rows_of_task(const Matrix<6, kDynamic>& rows, const std::string& task) {
  if (task == "pose") return array_of(rows);
  if (task == "position") return array_of(Matrix<3, kDynamic>(rows.topRows<3>()));
  if (task == "orientation") return array_of(Matrix<3, kDynamic>(rows.bottomRows<3>()));
  validation::reject("task", " = '" + task + "': must be 'position', 'orientation' or 'pose'");
}

Array center_of_mass_at(const PyRobot& model, const ArrayLike& q) {
  require_mass(model.robot);
  RobotState<kDynamic> state;
  model.robot.update(joint_vector(q, "q", model.dof()), state);
  Vector<3> center;
  Vector<3> velocity;
  Matrix<3, kDynamic> J;
  Matrix<3, kDynamic> Jd;
  center_of_mass(model.robot, state, center, velocity, J, Jd);
  return array_of(center);
}

/// Joints of a preset, each with the number of the parent link; frames; mass and centre of mass of the base.
py::typing::Tuple<py::typing::List<PlainTreeJoint>, py::typing::List<PlainFrame>, py::float_, Array> robot_preset(
    const std::string& name) {
  for (const presets::RobotPreset& known : presets::kRobots) {
    if (name != known.name) continue;
    py::list joints;
    py::list frames;
    const Tree<> tree = known.tree();
    for (const auto& [joint, parent] : tree.joints) {
      joints.append(py::make_tuple(fields_of(joint), parent));
    }
    for (const auto& [frame, link, offset] : tree.frames) frames.append(py::make_tuple(frame, link, array_of(offset)));
    return py::make_tuple(joints, frames, tree.base.mass, array_of(tree.base.centre));
  }
  validation::reject("name", " = '" + name + "': must be one of ROBOT_PRESETS");
}

py::typing::Dict<py::str, Array> bounds_of(const Model& model) {
  const auto& limits = model.limits();
  py::dict bounds;
  bounds["lower"] = array_of(limits.lower);
  bounds["upper"] = array_of(limits.upper);
  bounds["velocity"] = array_of(limits.velocity);
  bounds["acceleration"] = array_of(limits.acceleration);
  bounds["jerk"] = array_of(limits.jerk);
  bounds["velocity_offset"] = array_of(limits.velocity_offset);
  bounds["deceleration"] = array_of(limits.deceleration);
  bounds["effort"] = array_of(limits.effort);
  return bounds;
}

template <typename Presets>
py::tuple names_of(const Presets& presets) {
  py::list names;
  for (const auto& each : presets) names.append(each.name);
  return names;
}

void bind_robot(py::module_& m) {
  m.attr("MAX_DOF") = kMaxDof;
  m.attr("ROBOT_PRESETS") = names_of(presets::kRobots);
  m.def("robot_preset", &robot_preset, py::arg("name"));

  py::class_<Model>(m, "Model", "The compiled part of a robot or an arm: its joints and frames.")
      .def_property_readonly("dof", &Model::dof, "Number of joints n that have a drive.")
      .def_property_readonly(
          "joint_names", [](const Model& model) { return model.joint_names; },
          "Names of the joints that have a drive, from the base on.")
      .def("bounds", &bounds_of,
           "Bounds of the joints by name, as in JointLimits, shape (n,) each; infinite if there is no bound.");

  m.def(
      "link_frames",
      [](const Model& model, const ArrayLike& q) {
        std::vector<FrameOfLink> links(model.tree.joints.size() + 1);
        for (std::size_t i = 0; i < links.size(); ++i) links[i].first = static_cast<int>(i);
        return frames_in(model, q, links);
      },
      py::arg("model"), py::arg("q"), "Frames of the base and of all links in postures q, shape (K, links, 4, 4).");
  m.def(
      "named_frames",
      [](const Model& model, const ArrayLike& q, const std::string& frame) {
        return frames_in(model, q, {model.frame(frame)});
      },
      py::arg("model"), py::arg("q"), py::arg("frame"), "A frame in postures q, shape (K, 1, 4, 4).");

  const auto task = py::arg("task") = "pose";
  py::class_<PyRobot, Model>(m, "Robot", "The compiled part of a robot.")
      .def(py::init([](const py::typing::List<py::object>& joints, const py::typing::List<py::object>& frames,
                       double base_mass, const ArrayLike& base_center, const ArrayLike& gravity) {
             return PyRobot(tree_of_python(joints, frames, base_mass, base_center),
                            fixed_vector<3>(gravity, "gravity_vector"));
           }),
           py::arg("joints"), py::arg("frames"), py::arg("base_mass"), py::arg("base_center"), py::arg("gravity"))
      .def(
          "forward",
          [](const PyRobot& model, const ArrayLike& q, const std::string& frame) {
            return array_of(FrameState(model, q, q, frame).at);
          },
          py::arg("q"), py::arg("frame"),
          "Pose of a frame in the base frame [m], a homogeneous matrix, shape (4, 4). q: (n,) [rad].")
      .def(
          "jacobian",
          [](const PyRobot& model, const ArrayLike& q, const std::string& frame, const std::string& name) {
            return rows_of_task(FrameState(model, q, q, frame).J, name);
          },
          py::arg("q"), py::arg("frame"), py::kw_only(), task,
          "Jacobian of a frame, shape (m, n): the frame moves at J qd, linear rows first, then angular, in the base\n"
          "frame's axes. task: 'position', 'orientation' or 'pose'. q: (n,) [rad].")
      .def(
          "jacobian_dot",
          [](const PyRobot& model, const ArrayLike& q, const ArrayLike& qd, const std::string& frame,
             const std::string& name) { return rows_of_task(FrameState(model, q, qd, frame).Jd, name); },
          py::arg("q"), py::arg("qd"), py::arg("frame"), py::kw_only(), task,
          "dJ/dt along qd, shape (m, n): the frame's acceleration is J qdd + Jd qd. q, qd: (n,) [rad], [rad/s].")
      .def("center_of_mass", &center_of_mass_at, py::arg("q"),
           "Centre of mass in the base frame, shape (3,) [m], including the base. q: (n,) [rad].\n\n"
           "Raises ParameterError if the robot has no mass.");
}

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

void bind_model(py::module_& m) {
  bind_robot(m);
  m.attr("PRESETS") = names_of(presets::kAll);
  bind_kinematics(m);

  const auto task = py::arg("task") = "position";
  py::class_<Arm, Model>(m, "Arm", "The compiled part of an arm: planar, from link lengths, or in space, from joints.")
      .def(py::init([](const py::typing::List<py::object>& joints, const ArrayLike& tip, const ArrayLike& gravity,
                       const OptionalArray& lengths) {
             const Chain<> chain = chain_of(joints, tip);
             const auto g = fixed_vector<3>(gravity, "gravity_vector");
             return lengths ? Arm(joint_vector(*lengths, "lengths"), chain, g) : Arm(chain, g);
           }),
           py::arg("joints"), py::arg("tip"), py::arg("gravity"), py::arg("lengths") = py::none())
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
