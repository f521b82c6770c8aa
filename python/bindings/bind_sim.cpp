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
template <typename Space>
Simulation simulate_task(const TaskModel<Space>& model, const AnyPath<Space>& path, const PyScheme& scheme,
                         const State<kDynamic>& start, const TimeGrid<double>& grid) {
  require_redundant(Space::kRows, static_cast<int>(start.q.size()));
  const py::ssize_t rows = grid.samples();
  const py::ssize_t n = start.q.size();
  const auto points = [rows] {
    if constexpr (std::is_same_v<Space, Pose>) {
      return Array({rows, py::ssize_t{4}, py::ssize_t{4}});
    } else {
      return Array({rows, py::ssize_t{Space::kSize}});
    }
  };
  Array t(rows);
  Array q({rows, n});
  Array qd({rows, n});
  Array qdd({rows, n});
  Array x = points();
  Array x_ref = points();
  Array error({rows, py::ssize_t{Space::kRows}});
  const typename TaskModel<Space>::Buffers buffers{t.mutable_data(),    q.mutable_data(), qd.mutable_data(),
                                                   qdd.mutable_data(),  x.mutable_data(), x_ref.mutable_data(),
                                                   error.mutable_data()};
  RolloutResult<kDynamic> result;
  {
    const py::gil_scoped_release others_may_run;
    result = model.simulate(scheme, path, start, grid, buffers);
  }
  return py::make_tuple(result.status, result.time, result.samples, py::make_tuple(t, q, qd, qdd, x, x_ref, error));
}

Simulation simulate(const PyArm& arm, const PyPath& path, const PyScheme& scheme, const ArrayLike& q0,
                    const ArrayLike& qd0, double dt, double hold, const std::string& task) {
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), joint_vector(qd0, "qd0", arm.dof())};
  const TimeGrid<double> grid(path.duration(), dt, hold);
  return arm.visit(task, [&](const auto& model) {
    using Space = typename std::decay_t<decltype(model)>::Space;
    return simulate_task<Space>(model, path.as<Space>(), scheme, start, grid);
  });
}

}  // namespace

void bind_sim(py::module_& m) {
  m.def("simulate", &simulate, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("qd0"),
        py::arg("dt"), py::arg("hold"), py::arg("task"));
}

}  // namespace fpbm::bindings
