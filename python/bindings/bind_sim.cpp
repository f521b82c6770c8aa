#include <pybind11/typing.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "py_arm.hpp"

namespace fpbm::bindings {
namespace {

using Array = py::array_t<double>;
using Arrays = py::typing::Tuple<Array, Array, Array, Array, Array, Array, Array>;
using Simulation = py::typing::Tuple<Status, double, int, Arrays>;

/// (status, time, samples, arrays): arrays have room for every sample, of which the first `samples` are filled.
Simulation simulate(const PyPlanarArm& arm, const PyPath& path, const PyScheme& scheme, const ArrayLike& q0,
                    const ArrayLike& qd0, double dt, double hold) {
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), joint_vector(qd0, "qd0", arm.dof())};
  const TimeGrid<double> grid(path.duration(), dt, hold);
  const py::ssize_t rows = grid.samples();
  const py::ssize_t n = arm.dof();
  Array t(rows);
  Array q({rows, n});
  Array qd({rows, n});
  Array qdd({rows, n});
  Array x({rows, py::ssize_t{2}});
  Array x_ref({rows, py::ssize_t{2}});
  Array error({rows, py::ssize_t{2}});
  const ArmModel::Buffers buffers{t.mutable_data(), q.mutable_data(),     qd.mutable_data(),   qdd.mutable_data(),
                                  x.mutable_data(), x_ref.mutable_data(), error.mutable_data()};
  RolloutResult<kDynamic> result;
  {
    const py::gil_scoped_release others_may_run;
    result = arm.model().simulate(scheme, path, start, grid, buffers);
  }
  return py::make_tuple(result.status, result.time, result.samples, py::make_tuple(t, q, qd, qdd, x, x_ref, error));
}

}  // namespace

void bind_sim(py::module_& m) {
  m.def("simulate", &simulate, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("qd0"),
        py::arg("dt"), py::arg("hold"));
}

}  // namespace fpbm::bindings
