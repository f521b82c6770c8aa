#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fpbm/model/detail/center_of_mass.hpp"
#include "fpbm/model/detail/robot_presets.hpp"
#include "joints.hpp"
#include "model.hpp"

namespace fpbm::bindings {
namespace {

using PlainTreeJoint = py::typing::Tuple<PlainJoint, py::int_, py::float_, Array>;
using PlainFrame = py::typing::Tuple<py::str, py::int_, Array>;

/// A separate class, from which the Robot of Python is derived.
struct PyRobot : Model {
  using Model::Model;
};

LinkMass<> mass_of(double mass, const py::handle& center) {
  return {mass, fixed_vector<3>(ArrayLike(py::reinterpret_borrow<py::object>(center)), "center")};
}

/// A tree from objects with the attributes of fpbm_cpp.TreeJoint and fpbm_cpp.NamedFrame.
Tree<> tree_of_python(const py::typing::List<py::object>& joints, const py::typing::List<py::object>& frames,
                      double base_mass, const ArrayLike& base_center) {
  Tree<> tree;
  tree.base = mass_of(base_mass, base_center);
  for (const py::handle each : joints) {
    const auto i = static_cast<Eigen::Index>(tree.joints.size());
    tree.joints.push_back({joint_of_python(each.attr("joint"), validation::element("joints", i)),
                           py::cast<int>(each.attr("parent")),
                           mass_of(py::cast<double>(each.attr("mass")), each.attr("center"))});
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

/// Joints of a preset, each with the number of the parent link, and mass and centre of mass of the child link; frames;
/// mass and centre of mass of the base.
py::typing::Tuple<py::typing::List<PlainTreeJoint>, py::typing::List<PlainFrame>, py::float_, Array> robot_preset(
    const std::string& name) {
  for (const presets::RobotPreset& known : presets::kRobots) {
    if (name != known.name) continue;
    py::list joints;
    py::list frames;
    const Tree<> tree = known.tree();
    for (const auto& [joint, parent, moved] : tree.joints) {
      joints.append(py::make_tuple(fields_of(joint), parent, moved.mass, array_of(moved.centre)));
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
  return bounds;
}

}  // namespace

void bind_robot(py::module_& m) {
  m.attr("MAX_DOF") = kMaxDof;
  py::tuple names(std::size(presets::kRobots));
  for (std::size_t i = 0; i < std::size(presets::kRobots); ++i) names[i] = presets::kRobots[i].name;
  m.attr("ROBOT_PRESETS") = names;
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
                       double base_mass, const ArrayLike& base_center) {
             return PyRobot(tree_of_python(joints, frames, base_mass, base_center));
           }),
           py::arg("joints"), py::arg("frames"), py::arg("base_mass"), py::arg("base_center"))
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

}  // namespace fpbm::bindings
