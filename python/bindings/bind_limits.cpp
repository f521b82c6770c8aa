#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "arrays.hpp"
#include "bindings.hpp"
#include "limiter.hpp"

namespace fpbm::bindings {
namespace {

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
    py::array_t<bool> saturated(found.u.size());
    for (Eigen::Index i = 0; i < found.u.size(); ++i) saturated.mutable_at(i) = ((found.joints >> i) & 1U) != 0;
    return {array_of(found.u), found.scale, saturated};
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
}

}  // namespace fpbm::bindings
