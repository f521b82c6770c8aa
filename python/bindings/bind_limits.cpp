#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "limiter.hpp"

namespace fpbm::bindings {
namespace {

/// Motion of several task levels, in Python.
struct PyLevels {
  Array u;
  Array scale;
  py::array_t<bool> saturated;
};

using PyLevelRows = std::pair<ArrayLike, ArrayLike>;

/// lower and upper, one entry per joint each.
Box<kDynamic> box_of(const ArrayLike& lower, const ArrayLike& upper) {
  const Box<kDynamic> box{bound_vector(lower, "lower"), bound_vector(upper, "upper")};
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

/// A motion within limits, in Python.
struct PySaturatedMotion {
  Array u;
  double scale;
  py::array_t<bool> saturated;
};

using OptionalRows = std::optional<std::pair<ArrayLike, ArrayLike>>;
constexpr int kMostRows = 16;
static_assert(kMostRows <= kLimiterRows);

/// Bounds G u <= b on motions u of n joints.
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
    validation::fail("rows[1]'s number of entries", static_cast<double>(bounds.size()), "one for each row of rows[0]");
  }
  rows.g.leftCols(rows.count) = matrix(G, "rows[0]", rows.count, n).transpose();
  rows.b.head(rows.count) = Eigen::Map<const Eigen::VectorXd>(bounds.data(), bounds.size());
  validation::require_finite("rows[1]", rows.b);
  return rows;
}

/// A limiter at acceleration level or at velocity level.
class PyLimiter {
 public:
  PyLimiter(const py::object& limits, double dt, const std::string& level)
      : any_(make(joint_limits(limits), dt, level)) {}

  [[nodiscard]] PySaturatedMotion motion(const ArrayLike& J, const ArrayLike& q, const ArrayLike& qd,
                                         const ArrayLike& desired, const OptionalArray& last,
                                         const OptionalRows& bounds) const {
    const auto rows = real_array(J, "J", 2).shape(0);
    if (rows < 1 || rows > dof()) {
      validation::fail("J's number of rows", static_cast<double>(rows), "from 1 to the number of joints");
    }
    const State<kDynamic> state = state_of(q, qd);
    const Vector<kDynamic> before = last_of(last);
    const Matrix<kDynamic, kDynamic> jacobian = matrix(J, "J", rows, dof());
    const Vector<kDynamic> u = joint_vector(desired, "desired", dof());
    return python(limited_motion(any_, jacobian, state, u, before, bounds ? rows_of(*bounds, dof()) : LimiterRows{}));
  }

  [[nodiscard]] PySaturatedMotion brake(const ArrayLike& q, const ArrayLike& qd, const OptionalArray& last) const {
    const State<kDynamic> state = state_of(q, qd);
    return python(braking_motion(any_, state, last_of(last)));
  }

 private:
  static AnyLimiter make(const JointLimits<kDynamic>& limits, double dt, const std::string& level) {
    if (level == "acceleration") return Limiter(Limits<Level::kAcceleration, kDynamic>(limits, dt));
    if (level == "velocity") return Limiter(Limits<Level::kVelocity, kDynamic>(limits, dt));
    validation::reject("level", " = '" + level + "': must be 'acceleration' or 'velocity'");
  }

  [[nodiscard]] int dof() const {
    return std::visit([](const auto& limiter) { return static_cast<int>(limiter.limits().bounds().lower.size()); },
                      any_);
  }
  [[nodiscard]] State<kDynamic> state_of(const ArrayLike& q, const ArrayLike& qd) const {
    return {joint_vector(q, "q", dof()), joint_vector(qd, "qd", dof())};
  }
  [[nodiscard]] Vector<kDynamic> last_of(const OptionalArray& last) const {
    return last ? joint_vector(*last, "last", dof()) : Vector<kDynamic>::Zero(dof());
  }

  static PySaturatedMotion python(const SaturatedMotion<kDynamic>& found) {
    return {array_of(found.u), found.scale, array_of(found.joints, found.u.size())};
  }

  AnyLimiter any_;
};

}  // namespace

JointLimits<kDynamic> limits_of(const Model& model, const py::object& given) {
  if (given.is_none()) return model.limits();
  if (!py::hasattr(given, "of")) return joint_limits(given);
  return joint_limits(given.attr("of")(py::cast(&model, py::return_value_policy::reference)));
}

void bind_limits(py::module_& m) {
  const auto none = py::none();
  py::class_<PySaturatedMotion>(m, "SaturatedMotion", "A motion of one tick within limits.")
      .def_readonly("u", &PySaturatedMotion::u,
                    "Accelerations [rad/s^2], or velocities [rad/s] at velocity level, shape (n,).")
      .def_readonly("scale", &PySaturatedMotion::scale, "Task scale, from 0 to 1.")
      .def_readonly("saturated", &PySaturatedMotion::saturated, "Which joints are on a bound, shape (n,).");

  py::class_<PyLimiter>(m, "Limiter",
                        R"(Keeps joint limits in your own control loop, for any Jacobian.

A motion is unchanged if it keeps every bound over the next tick, and the joints can then stop within the bounds.
Otherwise, other joints replace joints on their bounds in the null space of J. If null-space motion is not sufficient,
the task is scaled without a change of direction.

Parameters
----------
limits : JointLimits
    Bounds of the joints, none missing: limits.of(arm) completes limits. A bounded joint needs a bound on acceleration,
    except at velocity level.
dt : float
    Length of a tick [s].
level : str
    Level of the limited motion: 'acceleration' or 'velocity'.

Raises
------
ParameterError
    If an argument is out of range or a bound is missing.)")
      .def(py::init<const py::object&, double, const std::string&>(), py::arg("limits"), py::arg("dt"), py::kw_only(),
           py::arg("level") = "acceleration")
      .def("motion", &PyLimiter::motion, py::arg("J"), py::arg("q"), py::arg("qd"), py::arg("desired"), py::kw_only(),
           py::arg("last") = none, py::arg("rows") = none,
           R"(Motion u of the next tick for a desired motion: J u = J r + s J (desired - r), with a braking motion r and
the largest s <= 1 within the limits. If s is near zero, u is a motion that still moves the tip toward the target.

J has shape (m, n); q, qd and desired (n,) [rad, rad/s, and rad/s^2 or rad/s]. At velocity level, qd is the last
command. last is the acceleration of the previous tick [rad/s^2], for bounds on jerk; default: zero. rows is a pair
(G, b), shapes (p, n) and (p,), of at most 16 further bounds G u <= b, kept as far as the limits admit. Raises
ParameterError if a shape is wrong, or a number is not finite.)")
      .def("brake", &PyLimiter::brake, py::arg("q"), py::arg("qd"), py::kw_only(), py::arg("last") = none,
           "The motion that brings every joint to rest; arguments and result as for motion.");

  bind_saturation(m);
}

}  // namespace fpbm::bindings
