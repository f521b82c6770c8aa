#include "bindings.hpp"
#include "motion_arrays.hpp"
#include "py_arm.hpp"

namespace fpbm::bindings {
namespace {

using Simulation = py::typing::Tuple<Status, double, int, Arrays>;

/// (status, time, samples, arrays): arrays have room for every sample, of which the first `samples` are filled.
template <typename Space>
Simulation simulate_task(const TaskModel<Space>& model, const AnyPath<Space>& path, const PyScheme& scheme,
                         const State<kDynamic>& start, const TimeGrid<double>& grid) {
  require_redundant(Space::kRows, static_cast<int>(start.q.size()));
  MotionArrays<Space> motion(grid.samples(), start.q.size());
  const Wanted<Space> wanted{motion.buffers()};
  RolloutResult<kDynamic> result;
  {
    const py::gil_scoped_release others_may_run;
    result = model.simulate(scheme, path, start, grid, wanted);
  }
  return py::make_tuple(result.status, result.time, result.samples, motion.arrays());
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
