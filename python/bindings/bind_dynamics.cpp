#include <pybind11/typing.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fpbm/model/dynamics.hpp"
#include "model.hpp"

namespace fpbm::bindings {
namespace {

/// Values of joints: one row for a joint vector, or K rows for an array of shape (K, n).
RowMajor rows_of(const ArrayLike& argument, const char* name, const Model& model, py::ssize_t rows) {
  if (rows < 0) return joint_vector(argument, name, model.dof()).transpose();
  return matrix<RowMajor>(argument, name, rows, model.dof());
}

/// The result of compute(dynamics, state, row, out) in each row of states, where out has the entries of `shape`.
template <typename F>
Array in_states(const Model& model, const ArrayLike& q, const OptionalArray& qd, std::vector<py::ssize_t> shape,
                const F& compute) {
  const AnyDynamics& dynamics = model.dynamics();
  const py::ssize_t rows = dimensions(q) == 2 ? real_array(q, "q", 2).shape(0) : -1;
  const RowMajor positions = rows_of(q, "q", model, rows);
  const RowMajor rates = qd ? rows_of(*qd, "qd", model, rows) : RowMajor();
  py::ssize_t size = 1;
  for (const py::ssize_t each : shape) size *= each;
  if (rows >= 0) shape.insert(shape.begin(), rows);
  Array result(shape);
  RobotState<kDynamic> state;
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    const JointVector at = positions.row(k);
    if (qd) {
      model.robot.update(at, JointVector(rates.row(k)), state);
    } else {
      model.robot.update(at, state);
    }
    compute(dynamics, state, k, result.mutable_data() + k * size);
  }
  return result;
}

void store(const JointVector& torque, double* out) {
  Eigen::Map<Eigen::VectorXd>(out, torque.size()) = torque;
}

Array inverse_dynamics(const Model& model, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& qdd) {
  const RowMajor accelerations = rows_of(qdd, "qdd", model, dimensions(q) == 2 ? real_array(q, "q", 2).shape(0) : -1);
  return in_states(model, q, qd, {model.dof()}, [&](const auto& dynamics, const auto& state, auto k, double* out) {
    store(dynamics.inverse_dynamics(state, JointVector(accelerations.row(k))), out);
  });
}

Array bias(const Model& model, const ArrayLike& q, const ArrayLike& qd) {
  return in_states(model, q, qd, {model.dof()}, [](const auto& dynamics, const auto& state, auto, double* out) {
    store(dynamics.bias(state), out);
  });
}

Array gravity(const Model& model, const ArrayLike& q) {
  return in_states(model, q, {}, {model.dof()}, [](const auto& dynamics, const auto& state, auto, double* out) {
    store(dynamics.gravity_torque(state), out);
  });
}

Array mass_matrix(const Model& model, const ArrayLike& q) {
  const py::ssize_t n = model.dof();
  return in_states(model, q, {}, {n, n}, [n](const auto& dynamics, const auto& state, auto, double* out) {
    Eigen::Map<RowMajor>(out, n, n) = dynamics.mass_matrix(state);
  });
}

/// A number for one state, an array of shape (K,) for K states.
using Energy = py::typing::Union<py::float_, Array>;

Energy energy(const Array& values) {
  return py::object(values[py::tuple()]);
}

Energy kinetic_energy(const Model& model, const ArrayLike& q, const ArrayLike& qd) {
  return energy(in_states(model, q, qd, {}, [](const auto& dynamics, const auto& state, auto, double* out) {
    *out = dynamics.kinetic_energy(state);
  }));
}

Energy potential_energy(const Model& model, const ArrayLike& q) {
  return energy(in_states(model, q, {}, {}, [](const auto& dynamics, const auto& state, auto, double* out) {
    *out = dynamics.potential_energy(state);
  }));
}

}  // namespace

const AnyDynamics& Model::dynamics() const {
  if (!dynamics_) {
    require_inertia(tree);
    dynamics_ = std::make_shared<const AnyDynamics>(tree, gravity);
  }
  return *dynamics_;
}

std::shared_ptr<const AnyDynamics> Model::dynamics_if_known() const noexcept {
  try {
    (void)dynamics();
  } catch (const std::invalid_argument&) {
    return nullptr;
  }
  return dynamics_;
}

JointVector torque_of(const AnyDynamics& dynamics, const JointVector& q, const JointVector& qd,
                      const JointVector& qdd) {
  RobotState<kDynamic> state;
  dynamics.robot().update(q, qd, state);
  return dynamics.inverse_dynamics(state, qdd);
}

void bind_dynamics(py::module_& m) {
  auto model = py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"));
  const auto q = py::arg("q");
  const auto qd = py::arg("qd");
  model
      .def(
          "locate",
          [](const Model& self, const std::string& frame) {
            const auto [link, offset] = self.frame(frame);
            return py::typing::Tuple<py::int_, Array>(py::make_tuple(link, array_of(offset)));
          },
          py::arg("frame"), "Number of the link of a frame, and the frame in the frame of the link, shape (4, 4).")
      .def_property_readonly(
          "has_dynamics", [](const Model& self) { return self.dynamics_if_known() != nullptr; },
          "Whether every drive moves a mass and all inertias are physical, so that torques are known.")
      .def("inverse_dynamics", &inverse_dynamics, q, qd, py::arg("qdd"),
           R"(Torques of the drives for a motion: M(q) qdd + h(q, qd), shape (n,) [Nm], [N] for prismatic joints.

By the recursive Newton-Euler algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1), with the
inertia of the rotors and viscous friction, without dry friction. q, qd, qdd: shape (n,) [rad], [rad/s], [rad/s^2], or
K rows, shape (K, n), for a result of shape (K, n).

Raises ParameterError if a drive moves no mass, an inertia is not physical, or an argument has a wrong shape.)")
      .def("mass_matrix", &mass_matrix, q,
           R"(Joint-space inertia matrix M(q), shape (n, n) [kg m^2], symmetric and positive definite.

By the composite-rigid-body algorithm (Featherstone 2008, table 6.2). M is the derivative of inverse_dynamics() with
respect to qdd, and includes the inertia of the rotors. q: shape (n,) [rad], or (K, n) for a result of shape (K, n, n).

Raises ParameterError as inverse_dynamics() does.)")
      .def("bias", &bias, q, qd,
           R"(Torques for a motion without acceleration: h(q, qd) = C(q, qd) qd + g(q) + damping qd, shape (n,) [Nm].

h = inverse_dynamics(q, qd, 0): Coriolis and centrifugal torques, gravity and viscous friction. q, qd: shape (n,)
[rad], [rad/s], or (K, n) for a result of shape (K, n).

Raises ParameterError as inverse_dynamics() does.)")
      .def("gravity", &gravity, q,
           R"(Torques that hold the robot at rest: g(q) = inverse_dynamics(q, 0, 0), shape (n,) [Nm].

g is the gradient of potential_energy(). q: shape (n,) [rad], or (K, n) for a result of shape (K, n).

Raises ParameterError as inverse_dynamics() does.)")
      .def("kinetic_energy", &kinetic_energy, q, qd,
           R"(Kinetic energy 1/2 qd^T M(q) qd [J], rotors included.

q, qd: shape (n,) [rad], [rad/s], or (K, n) for a result of shape (K,).

Raises ParameterError as inverse_dynamics() does.)")
      .def("potential_energy", &potential_energy, q,
           R"(Potential energy of the links in the field of gravity [J], zero for links at the origin of the base frame.

The base does not count. q: shape (n,) [rad], or (K, n) for a result of shape (K,).

Raises ParameterError as inverse_dynamics() does.)");
}

}  // namespace fpbm::bindings
