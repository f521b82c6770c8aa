#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "fpbm/bound/preset_capsules.hpp"
#include "read.hpp"

namespace fpbm::bindings {
namespace {

/// The clearance of an arm from an fpbm_cpp.Clearance. Throws std::invalid_argument if the clearance does not fit the
/// arm.
Clearance<kDynamic> clearance_of(const Model& model, const py::handle& given) {
  require_class(given, "clearance", "Clearance", "clearance", "a Clearance");
  const auto name = [](const py::handle& shape) { return py::cast<std::string>(field(shape, "name")); };
  std::vector<LinkCapsule<>> capsules;
  for (const py::handle each : field(given, "capsules")) {
    const auto& shape = py::cast<const Shape&>(each);
    capsules.push_back({shape.link, std::get<Capsule<>>(shape.any), name(each)});
  }
  std::vector<Obstacle<>> obstacles;
  for (const py::handle each : field(given, "obstacles")) {
    obstacles.emplace_back(name(each), py::cast<const Shape&>(each).any);
  }
  using Allowed = std::vector<Clearance<kDynamic>::Names>;
  Clearance<kDynamic> clearance(model.tree, capsules, obstacles, py::cast<double>(field(given, "margin")),
                                py::cast<Allowed>(field(given, "allowed")));
  clearance.keep_away({py::cast<double>(field(given, "away_gain")), py::cast<double>(field(given, "away_range"))});
  return clearance;
}

/// The bounds on torques from an fpbm_cpp.TorqueBounds. Throws std::invalid_argument if the arm has no efforts.
TorqueBounds<kDynamic> torque_bounds_of(const Model& model, const py::handle& given) {
  const py::object effort = field(given, "effort");
  JointVector most = model.limits().effort;
  if (!effort.is_none()) {
    const auto values = py::cast<py::array_t<double>>(effort);
    if (values.ndim() == 0) {
      most.setConstant(py::cast<double>(effort));
    } else {
      most = bound_vector(ArrayLike(effort), "effort");
    }
  }
  validation::require_size("effort", most.size(), model.dof());
  if (!is_finite(most) && !most.array().isFinite().any()) {
    validation::reject("effort", ": must be given, because the arm has no efforts: TorqueBounds(effort=...)");
  }
  most *= py::cast<double>(field(given, "fraction"));
  std::optional<AnyDynamics> lighter;
  if (const py::object other = field(given, "lighter"); !other.is_none()) {
    const auto& light = py::cast<const Model&>(other);
    if (light.joint_names != model.joint_names || light.gravity != model.gravity) {
      validation::reject("lighter", ": must be the same arm, with a smaller payload");
    }
    lighter = light.dynamics();
  }
  return {model.tree, model.dynamics(), most, lighter};
}

/// Adds an fpbm_cpp.TaskBounds.
void add_task_bounds(TaskBounds<kDynamic>& walls, SpeedBounds<kDynamic>& speeds, const Model& model,
                     const py::handle& given) {
  const py::object task = field(given, "task");
  const auto name = py::cast<std::string>(field(task, "name"));
  const auto number = [&](const char* key) { return py::cast<double>(field(given, key)); };
  const auto vector = [](const py::handle& of, const char* key) { return direction(ArrayLike(field(of, key)), key); };
  SpeedBound<> speed{read_frame(task, model), number("velocity")};
  if (py::cast<const Task&>(task).kind == TaskKind::kAxis) {
    speed.axis = vector(task, "axis");
    walls.keep(AxisBounds<>{speed.frame, *speed.axis, vector(task, "x"), number("least_angle"), number("largest_angle"),
                            number("deceleration"), name});
  } else {
    speed.rows = py::cast<std::array<bool, 3>>(field(given, "selected"));
    const auto limit = [&](const char* key) {
      Vector<3> values;
      for (std::size_t i = 0; i < 3; ++i) {
        values(static_cast<Eigen::Index>(i)) = py::cast<double>(field(given, key)[py::int_(i)]);
      }
      return values;
    };
    walls.keep(
        PositionBounds<>{speed.frame, limit("lower_corner"), limit("upper_corner"), number("deceleration"), name});
  }
  speeds.keep(speed);
}

using PlainCapsule = py::typing::Tuple<py::int_, Array, Array, py::float_, py::str>;
using PlainPair = py::typing::Tuple<py::str, py::str>;

/// Link, ends, radius and name of each capsule of a preset; and the names of the pairs that may overlap.
py::typing::Tuple<py::typing::List<PlainCapsule>, py::typing::List<PlainPair>> preset_capsules(
    const std::string& name) {
  std::vector<presets::PresetCapsules> presets(std::begin(presets::kAllCapsules), std::end(presets::kAllCapsules));
  presets.insert(presets.end(), std::begin(presets::kRobotCapsules), std::end(presets::kRobotCapsules));
  std::string names;
  for (const auto& preset : presets) {
    names += (names.empty() ? "" : ", ") + std::string(preset.name);
    if (name != preset.name) continue;
    py::list capsules;
    for (const auto& [link, capsule, title] : preset.capsules()) {
      capsules.append(py::make_tuple(link, array_of(capsule.a), array_of(capsule.b), capsule.radius, title));
    }
    return py::make_tuple(capsules, py::cast(preset.never_collide()));
  }
  validation::reject("name", " = '" + name + "': must be one of " + names);
}

Shape capsule(const ArrayLike& a, const ArrayLike& b, double radius, int link) {
  validation::require_non_negative("radius", radius);
  return {Capsule<>{fixed_vector<3>(a, "a"), fixed_vector<3>(b, "b"), radius}, link};
}

Shape half_space(const ArrayLike& normal, double offset) {
  const Vector<3> n = fixed_vector<3>(normal, "normal");
  if (!(n.stableNorm() > 0.0)) validation::reject("normal", " is zero: must be a nonzero vector");
  validation::require_finite("offset", offset);
  return {HalfSpace<>{n.stableNormalized(), offset}};
}

Shape cuboid(const ArrayLike& pose, const ArrayLike& half) {
  const Vector<3> edges = fixed_vector<3>(half, "half");
  for (int i = 0; i < 3; ++i) validation::require_non_negative(validation::element("half", i), edges(i));
  return {Cuboid<>{transform(pose, "pose"), edges}};
}

}  // namespace

AnyBounds bounds_of(const Model& model, const py::object& given) {
  if (!py::isinstance<py::iterable>(given)) reject_type(given, "bounds", kBoundsDemand);
  Clearance<kDynamic> clearance(model.tree, {}, {}, 0.0);
  TaskBounds<kDynamic> walls(model.tree);
  SpeedBounds<kDynamic> speeds(model.tree);
  std::optional<OptionalTorqueBounds> torques;
  bool is_clear = false;
  for (const py::handle each : given) {
    if (is_class(each, "clearance", "Clearance")) {
      if (is_clear) validation::reject("bounds", " has two Clearances: must have at most one, with all shapes");
      clearance = clearance_of(model, each);
      is_clear = true;
    } else if (is_class(each, "torque_bounds", "TorqueBounds")) {
      if (torques) validation::reject("bounds", " has two TorqueBounds: must have at most one");
      torques.emplace(torque_bounds_of(model, each));
    } else {
      require_class(each, "task_bounds", "TaskBounds", "bounds", kBoundsDemand);
      add_task_bounds(walls, speeds, model, each);
    }
  }
  return AnyBounds(clearance, walls, speeds, torques ? *torques : OptionalTorqueBounds());
}

std::optional<PyNearest> nearest_at(const Clearance<kDynamic>& clearance, const JointVector& q) {
  if (clearance.empty()) return std::nullopt;
  auto placed = clearance.placement();
  const ShapePair& pair = clearance.pairs()[clearance.nearest_pair(q, placed).first];
  const auto found = clearance.nearest_of(placed, pair);
  Matrix<2, 3> points;
  points << found.on_first.transpose(), found.on_second.transpose();
  return PyNearest{clearance.names(pair), found.distance, points};
}

void move_obstacle(Clearance<kDynamic>& clearance, const std::string& name, const Shape& shape,
                   const Vector<3>& velocity) {
  const auto& obstacles = clearance.obstacles();
  const auto found =
      std::find_if(obstacles.begin(), obstacles.end(), [&](const auto& each) { return each.name == name; });
  if (found == obstacles.end()) {
    std::string names;
    for (const auto& each : obstacles) names += (names.empty() ? "" : ", ") + each.name;
    validation::reject("name", " = '" + name + "': must be one of the obstacles: " + (names.empty() ? "none" : names));
  }
  if (shape.any.index() != found->shape.index()) {
    struct {
      const char* operator()(const Capsule<>&) const { return "Capsule"; }
      const char* operator()(const HalfSpace<>&) const { return "HalfSpace"; }
      const char* operator()(const Cuboid<>&) const { return "Cuboid"; }
    } kind;
    validation::reject("shape",
                       std::string(": must be a ") + std::visit(kind, found->shape) + ", like obstacle '" + name + "'");
  }
  if (shape.link != 0) validation::fail("shape.link", shape.link, "0, the base");
  clearance.move(static_cast<std::size_t>(found - obstacles.begin()), shape.any, velocity);
}

void bind_clearance(py::module_& m) {
  py::class_<Shape>(m, "Shape", "The compiled part of a shape.")
      .def(py::init(&capsule), py::kw_only(), py::arg("a"), py::arg("b"), py::arg("radius"), py::arg("link"))
      .def(py::init(&half_space), py::kw_only(), py::arg("normal"), py::arg("offset"))
      .def(py::init(&cuboid), py::kw_only(), py::arg("pose"), py::arg("half"));

  m.def("preset_capsules", &preset_capsules, py::arg("name"));

  py::class_<PyNearest>(m, "Nearest", "The nearest checked pair of shapes.")
      .def_readonly("pair", &PyNearest::pair, "Names: of a capsule of the arm, and of the other shape.")
      .def_readonly("distance", &PyNearest::distance, "Distance [m]; if negative, the penetration depth.")
      .def_property_readonly(
          "points", [](const PyNearest& nearest) { return array_of(nearest.points); },
          "Nearest points on the surfaces of both shapes in the base frame, shape (2, 3) [m].")
      .def("__repr__", [](const PyNearest& nearest) {
        return py::str("<Nearest: {} and {}, {:.6g} m apart>")
            .format(nearest.pair.first, nearest.pair.second, nearest.distance);
      });

  using Compiled = Clearance<kDynamic>;
  const auto names = [](const std::vector<ShapePair>& (Compiled::*pairs)() const) {
    return [pairs](const Compiled& self) {
      std::vector<Compiled::Names> found;
      for (const ShapePair& pair : (self.*pairs)()) found.push_back(self.names(pair));
      return found;
    };
  };
  py::class_<Compiled>(m, "Clearance", "The compiled part of a clearance, for one robot.")
      .def(py::init([](const Given<Model>& model, const py::object& given) {
             return clearance_of(model.as("arm", "an arm or a Robot"), given);
           }),
           py::arg("arm"), py::arg("clearance"))
      .def(
          "nearest",
          [](const Compiled& self, const ArrayLike& q) {
            return nearest_at(self, joint_vector(q, "q", self.robot().dof()));
          },
          py::arg("q"))
      .def("pairs", names(&Compiled::pairs))
      .def("excluded_pairs", names(&Compiled::excluded_pairs));
}

}  // namespace fpbm::bindings
