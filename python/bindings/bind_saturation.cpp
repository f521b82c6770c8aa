#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "saturate.hpp"

namespace fpbm::bindings {
namespace {

/// Motion of several task levels, in Python.
struct PyLevels {
  Array u;
  Array scale;
  py::array_t<bool> saturated;
};

using PyLevelRows = std::pair<ArrayLike, ArrayLike>;

/// Bounds of motions, which may be infinite but not NaN.
JointVector bounds_of(const ArrayLike& argument, const char* name) {
  const JointVector values = joint_vector(argument, name);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::isnan(values(i))) validation::fail(validation::element(name, i), values(i), "a number");
  }
  return values;
}

/// lower and upper, one entry per joint each.
Box<kDynamic> box_of(const ArrayLike& lower, const ArrayLike& upper) {
  const Box<kDynamic> box{bounds_of(lower, "lower"), bounds_of(upper, "upper")};
  validation::require_size("upper", box.upper.size(), box.lower.size());
  for (Eigen::Index i = 0; i < box.lower.size(); ++i) {
    if (box.lower(i) > box.upper(i)) {
      validation::fail(validation::element("lower", i), box.lower(i), "at most upper = ", box.upper(i));
    }
  }
  return box;
}

/// Defaults: the motion in the box nearest to zero, and units of half the width of the box.
JointVector rest_in(const Box<kDynamic>& box, const OptionalArray& given) {
  const auto n = static_cast<int>(box.lower.size());
  if (!given) return box.nearest(JointVector::Zero(n));
  const JointVector rest = joint_vector(*given, "rest", n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (rest(i) < box.lower(i) || rest(i) > box.upper(i)) {
      validation::fail(validation::element("rest", i), rest(i), "from lower to upper");
    }
  }
  return rest;
}
JointVector unit_of(const Box<kDynamic>& box, const OptionalArray& given) {
  const auto n = static_cast<int>(box.lower.size());
  if (given) {
    const JointVector unit = joint_vector(*given, "unit", n);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!(unit(i) > 0.0)) validation::fail(validation::element("unit", i), unit(i), "positive");
    }
    return unit;
  }
  JointVector unit = (box.upper - box.lower) / 2.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!std::isfinite(unit(i)) || unit(i) == 0.0) unit(i) = 1.0;
  }
  // With units 1e10 apart, the motion of a joint with a small range would be round-off error.
  return unit.cwiseMax(1e-3 * unit.maxCoeff());
}

PyLevels saturate_levels(const std::vector<PyLevelRows>& given, const ArrayLike& lower, const ArrayLike& upper,
                         const OptionalArray& rest, const OptionalArray& unit) {
  if (given.empty()) validation::reject("levels", ": must have at least one level");
  const Box<kDynamic> box = box_of(lower, upper);
  const Eigen::Index n = box.lower.size();
  std::vector<LevelRows> levels;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const std::string level = "levels[" + std::to_string(k) + "]";
    const std::string J = level + "'s J";
    const std::string b = level + "'s b";
    const auto rows = real_array(given[k].first, J.c_str(), 2).shape(0);
    if (rows < 1 || rows > kMaxDof) {
      validation::fail((J + "'s number of rows").c_str(), static_cast<double>(rows),
                       "from 1 to " + std::to_string(kMaxDof));
    }
    const JointVector values = joint_vector(given[k].second, b.c_str(), static_cast<int>(rows));
    levels.emplace_back(matrix(given[k].first, J.c_str(), rows, n), values);
  }
  const JointVector units = unit_of(box, unit);
  const Levels found = saturate(levels, box, rest_in(box, rest), units);
  py::array_t<bool> saturated(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double room = std::min(found.u(i) - box.lower(i), box.upper(i) - found.u(i));
    // Joints that are linearly dependent on held joints stop within round-off of their bounds.
    saturated.mutable_at(i) = room <= 1e-12 * units(i);
  }
  return {
      array_of(found.u),
      array_of(Eigen::Map<const Eigen::VectorXd>(found.scale.data(), static_cast<Eigen::Index>(found.scale.size()))),
      saturated};
}

}  // namespace

void bind_saturation(py::module_& m) {
  const auto none = py::none();
  py::class_<PyLevels>(m, "SaturatedLevels", "Motion of several task levels in strict priority within bounds.")
      .def_readonly("u", &PyLevels::u, "The motion within the bounds, shape (n,).")
      .def_readonly("scale", &PyLevels::scale, "Task scale of each level, from 0 to 1, shape (levels,).")
      .def_readonly("saturated", &PyLevels::saturated, "Which joints are on a bound, shape (n,).");

  m.def("saturate", &saturate_levels, py::arg("levels"), py::arg("lower"), py::arg("upper"), py::kw_only(),
        py::arg("rest") = none, py::arg("unit") = none,
        R"(Resolves tasks J u = b in strict priority within lower <= u <= upper.

From u_0 = rest, level by level,

    d = u_{k-1} + Z_{k-1} pinv(J_k Z_{k-1}) (b_k - J_k u_{k-1})
    u_k = u_{k-1} + s_k (d - u_{k-1}) + Z_k g,    lower <= u_k <= upper,    0 <= s_k <= 1 as large as possible,

where the columns of Z_k are a basis of the null space of J_1 ... J_k, and the null-space motion g replaces joints on
their bounds by other joints. A lower level never changes J u of a higher level. Each scale s_k is the optimum of a
linear program.

Parameters
----------
levels : sequence of (J, b)
    The task levels, highest priority first: J of shape (m, n), b of shape (m,), m at most MAX_DOF. Rows may be linearly
    dependent. If the higher levels contradict a task, d is the least-squares solution.
lower, upper : array_like, shape (n,)
    Bounds of each joint's motion; infinite if there is none.
rest : array_like, shape (n,), optional
    Initial motion within the bounds, such as the braking motion of a control loop. Default: the motion nearest to zero.
unit : array_like, shape (n,), optional
    Unit of each joint's motion: the norm that d and g minimise is measured in these units. Default: half the distance
    between the bounds, but at least 1e-3 of the largest unit.

Raises
------
ParameterError
    If a shape does not fit, a number is not finite, lower exceeds upper, or rest is outside the bounds.)");
}

}  // namespace fpbm::bindings
