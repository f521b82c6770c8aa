#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "arrays.hpp"
#include "bindings.hpp"
#include "limiter.hpp"
#include "saturate.hpp"

namespace fpbm::bindings {
namespace {

constexpr int kOpen = kDynamic;

/// A motion within limits, as Python has it.
struct PyMotion {
  Array u;
  double scale;
  py::array_t<bool> saturated;
};

using OptionalRows = std::optional<std::pair<ArrayLike, ArrayLike>>;
constexpr int kMostRows = 16;
static_assert(kMostRows <= kLimiterRows);

/// Bounds on motions of n joints, of G u <= b.
LimiterRows rows_of(const std::pair<ArrayLike, ArrayLike>& given, int n) {
  const auto& [G, b] = given;
  LimiterRows rows;
  rows.g.setZero(n, kLimiterRows);
  rows.b.setZero();
  rows.count = real_array(G, "rows[0]", 2).shape(0);
  if (rows.count > kMostRows) {
    validation::fail("rows[0]'s number of rows", static_cast<double>(rows.count), "at most 16");
  }
  const auto bounds = real_array(b, "rows[1]", 1);
  if (bounds.size() != rows.count) {
    validation::fail("rows[1]'s number of entries", static_cast<double>(bounds.size()), "one for each of rows[0]");
  }
  rows.g.leftCols(rows.count) = matrix(G, "rows[0]", rows.count, n).transpose();
  rows.b.head(rows.count) = Eigen::Map<const Eigen::VectorXd>(bounds.data(), bounds.size());
  validation::require_finite("rows[1]", rows.b);
  return rows;
}

/// A limiter of either level.
class PyLimiter {
 public:
  PyLimiter(const py::object& limits, double dt, const std::string& level)
      : any_(make(joint_limits(limits), dt, level)) {}

  [[nodiscard]] PyMotion motion(const ArrayLike& J, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& desired,
                                const OptionalArray& last, const OptionalRows& bounds) const {
    const auto rows = real_array(J, "J", 2).shape(0);
    if (rows < 1 || rows > dof()) {
      validation::fail("J's number of rows", static_cast<double>(rows), "from 1 to the number of joints");
    }
    const State<kOpen> state = state_of(q, qd);
    const Vector<kOpen> before = last_of(last);
    const Matrix<kOpen, kOpen> jacobian = matrix(J, "J", rows, dof());
    const Vector<kOpen> wanted = joint_vector(desired, "desired", dof());
    return python(
        limited_motion(any_, jacobian, state, wanted, before, bounds ? rows_of(*bounds, dof()) : LimiterRows{}));
  }

  [[nodiscard]] PyMotion brake(const ArrayLike& q, const ArrayLike& qd, const OptionalArray& last) const {
    const State<kOpen> state = state_of(q, qd);
    return python(braking_motion(any_, state, last_of(last)));
  }

 private:
  static AnyLimiter make(const JointLimits<kOpen>& limits, double dt, const std::string& level) {
    if (level == "acceleration") return Limiter(Limits<Level::kAcceleration, kOpen>(limits, dt));
    if (level == "velocity") return Limiter(Limits<Level::kVelocity, kOpen>(limits, dt));
    validation::reject("level", " = '" + level + "': must be 'acceleration' or 'velocity'");
  }

  [[nodiscard]] int dof() const {
    return std::visit([](const auto& limiter) { return static_cast<int>(limiter.limits().bounds().lower.size()); },
                      any_);
  }
  [[nodiscard]] State<kOpen> state_of(const ArrayLike& q, const ArrayLike& qd) const {
    return {joint_vector(q, "q", dof()), joint_vector(qd, "qd", dof())};
  }
  [[nodiscard]] Vector<kOpen> last_of(const OptionalArray& last) const {
    return last ? joint_vector(*last, "last", dof()) : Vector<kOpen>::Zero(dof());
  }

  static PyMotion python(const Saturated<kOpen>& found) {
    py::array_t<bool> saturated(found.u.size());
    for (Eigen::Index i = 0; i < found.u.size(); ++i) saturated.mutable_at(i) = ((found.joints >> i) & 1U) != 0;
    return {array_of(found.u), found.scale, saturated};
  }

  AnyLimiter any_;
};

/// Motion of several task levels, as Python has it.
struct PyLevels {
  Array u;
  Array scale;
  py::array_t<bool> saturated;
};

using PyLevelRows = std::pair<ArrayLike, ArrayLike>;

/// Bounds of n motions; may be infinite, not NaN.
JointVector bounds_of(const ArrayLike& argument, const char* name, Eigen::Index n) {
  const JointVector values = joint_vector(argument, name);
  validation::require_size(name, values.size(), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::isnan(values(i))) validation::fail(validation::element(name, i), values(i), "a number");
  }
  return values;
}

/// Defaults: the motion in the box nearest to zero, and units of half the width of the box.
JointVector rest_in(const Box<kOpen>& box, const OptionalArray& given) {
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
JointVector unit_of(const Box<kOpen>& box, const OptionalArray& given) {
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
  // Units 1e10 apart would make the motion of a joint with little range round-off error.
  return unit.cwiseMax(1e-3 * unit.maxCoeff());
}

PyLevels saturate_levels(const std::vector<PyLevelRows>& given, const ArrayLike& lower, const ArrayLike& upper,
                         const OptionalArray& rest, const OptionalArray& unit) {
  if (given.empty()) validation::reject("levels", ": must be one at least");
  const JointVector low = joint_vector(lower, "lower");
  const Eigen::Index n = low.size();
  const Box<kOpen> box{bounds_of(lower, "lower", n), bounds_of(upper, "upper", n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    if (box.lower(i) > box.upper(i)) {
      validation::fail(validation::element("lower", i), box.lower(i), "at most upper, " + std::to_string(box.upper(i)));
    }
  }
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

void bind_limits(py::module_& m) {
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
their bounds by others. A lower level never changes J u of a higher one. Each scale s_k is the optimum of a linear program.

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
    between the bounds, but at least 1e-3 of the largest.

Raises
------
ParameterError
    If a shape does not fit, a number is not finite, lower exceeds upper, or rest is outside the bounds.)");
  py::class_<PyMotion>(m, "LimitedMotion", "A motion of one tick within limits.")
      .def_readonly("u", &PyMotion::u, "Accelerations [rad/s^2], or velocities [rad/s] at that level, shape (n,).")
      .def_readonly("scale", &PyMotion::scale, "How much of the task is left, from 0 to 1.")
      .def_readonly("saturated", &PyMotion::saturated, "Which joints are on a bound, shape (n,).");

  py::class_<PyLimiter>(m, "Limiter",
                        R"(Keeps joint limits in a loop of one's own, with a Jacobian from anywhere.

A motion that keeps every bound over the next tick, and can be brought to rest within them, passes unchanged. Otherwise
other joints take over in the null space of J; where they cannot, the task is scaled down along its direction.

Parameters
----------
limits : JointLimits
    Bounds of the joints; one with bounds needs one on its acceleration, except at velocity level.
dt : float
    Length of a tick [s].
level : str
    'acceleration' or 'velocity': what is limited.

Raises
------
ParameterError
    Where an argument is out of range or a bound is missing.)")
      .def(py::init<const py::object&, double, const std::string&>(), py::arg("limits"), py::arg("dt"), py::kw_only(),
           py::arg("level") = "acceleration")
      .def(
          "motion", &PyLimiter::motion, py::arg("J"), py::arg("q"), py::arg("qd"), py::arg("desired"), py::kw_only(),
          py::arg("last") = none, py::arg("rows") = none,
          R"(The motion u of the next tick for a desired one: J u = J r + s J (desired - r), with a motion r that slows the arm
down and s <= 1 as large as the limits allow; where s comes near zero, a motion that still brings the tip nearer.

J has shape (m, n); q, qd and desired (n,) [rad, rad/s, and rad/s^2 or rad/s]. At velocity level qd is the last command.
last is the acceleration of the tick before [rad/s^2], from which bounds on jerk start: zero unless given. rows is a pair
(G, b), shapes (p, n) and (p,), of further bounds G u <= b, 16 at most, kept as far as the limits admit. Raises
ParameterError where a shape is another, or a number is not finite.)")
      .def("brake", &PyLimiter::brake, py::arg("q"), py::arg("qd"), py::kw_only(), py::arg("last") = none,
           "The motion that brings every joint to rest, as motion.");
}

}  // namespace fpbm::bindings
