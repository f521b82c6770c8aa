#include "bindings.hpp"
#include "motion_arrays.hpp"
#include "path.hpp"

namespace fpbm::bindings {
namespace {

/// Status, time of the last sample, number of samples, and arrays of which that many rows are filled.
using Outcomes = py::typing::Tuple<Status, double, int, Arrays>;

/// A whole motion, run without the interpreter's lock; within limits where there are options of them.
Outcomes rollout(const Arm& arm, const Path& path, const Scheme& scheme, const ArrayLike& q0, const ArrayLike& qd0,
                 double dt, double hold, const std::string& task, const std::optional<LimitedOptions>& options) {
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), joint_vector(qd0, "qd0", arm.dof())};
  const TimeGrid<double> grid(path.duration(), dt, hold);
  const std::optional<Limited> limited = limited_of(options, arm);
  return arm.visit(task, [&](const auto& any, auto space) -> Outcomes {
    using Space = decltype(space);
    require_enough_joints<Space>(arm.dof());
    const AnyPath<Space> same = path.as<Space>();
    MotionArrays<Space> arrays(grid.samples(), arm.dof(), limited.has_value(), keeps_clear(options));
    const Output<Space> output = arrays.output();
    const Motion<Space> motion{any, same, scheme, start, grid};
    RolloutResult<kDynamic> result;
    {
      const py::gil_scoped_release others_may_run;
      result = limited ? motion.track(*limited, output) : motion.simulate(output);
    }
    return py::make_tuple(result.status, result.time, result.samples, arrays.all());
  });
}

}  // namespace

void bind_sim(py::module_& m) {
  m.def("rollout", &rollout, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("qd0"),
        py::arg("dt"), py::arg("hold"), py::arg("task"), py::arg("limited") = py::none());
}

}  // namespace fpbm::bindings
