#include "bindings.hpp"
#include "motion_arrays.hpp"
#include "path.hpp"

namespace fpbm::bindings {
namespace {

using Simulation = py::typing::Tuple<Status, double, int, Arrays>;
using Tracked = py::typing::Tuple<Status, double, int, Arrays, Array, py::array_t<bool>>;

/// Runs a motion without the interpreter's lock, as `limited` says, and calls visitor(result, arrays) with what it came
/// to. The arrays have room for every sample, of which the first result.samples are filled.
template <typename Visitor>
auto run(const Arm& arm, const Path& path, const Scheme& scheme, const ArrayLike& q0, const ArrayLike& qd0, double dt,
         double hold, const std::string& task, const Limited* limited, Visitor&& visitor) {
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), joint_vector(qd0, "qd0", arm.dof())};
  const TimeGrid<double> grid(path.duration(), dt, hold);
  return arm.visit(task, [&](const auto& any, auto space) {
    using Space = decltype(space);
    require_enough_joints<Space>(arm.dof());
    const AnyPath<Space> same = path.as<Space>();
    MotionArrays<Space> arrays(grid.samples(), arm.dof(), limited != nullptr);
    const Output<Space> output = arrays.output();
    const Motion<Space> motion{any, same, scheme, start, grid};
    RolloutResult<kDynamic> result;
    {
      const py::gil_scoped_release others_may_run;
      result = limited != nullptr ? motion.track(*limited, output) : motion.simulate(output);
    }
    return visitor(result, arrays);
  });
}

Simulation simulate(const Arm& arm, const Path& path, const Scheme& scheme, const ArrayLike& q0, const ArrayLike& qd0,
                    double dt, double hold, const std::string& task) {
  return run(arm, path, scheme, q0, qd0, dt, hold, task, nullptr, [](const auto& result, const auto& all) {
    return Simulation(py::make_tuple(result.status, result.time, result.samples, all.arrays()));
  });
}

Tracked track(const Arm& arm, const Path& path, const Scheme& scheme, const ArrayLike& q0, const ArrayLike& qd0,
              double dt, double hold, const std::string& task, const py::object& limits, double max_error,
              double integral_gain, double integral_bound, double singular_radius, double singular_brake) {
  const LimitedOptions options{limits, max_error, integral_gain, integral_bound, singular_radius, singular_brake};
  const Limited limited = limited_of(options, arm);
  return run(arm, path, scheme, q0, qd0, dt, hold, task, &limited, [](const auto& result, const auto& all) {
    return Tracked(py::make_tuple(result.status, result.time, result.samples, all.arrays(), all.scale, all.saturated));
  });
}

}  // namespace

void bind_sim(py::module_& m) {
  m.def("simulate", &simulate, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("qd0"),
        py::arg("dt"), py::arg("hold"), py::arg("task"));
  m.def("track", &track, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("qd0"),
        py::arg("dt"), py::arg("hold"), py::arg("task"), py::arg("limits"), py::arg("max_error"),
        py::arg("integral_gain"), py::arg("integral_bound"), py::arg("singular_radius"), py::arg("singular_brake"));
}

}  // namespace fpbm::bindings
