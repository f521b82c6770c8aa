#include <algorithm>
#include <stdexcept>

#include "bindings.hpp"
#include "clearance.hpp"
#include "motion_arrays.hpp"
#include "read_stack.hpp"

namespace fpbm::bindings {
namespace {

/// Status, time of the last sample, number of samples, and arrays with this number of filled rows.
using Outcomes = py::typing::Tuple<Status, double, int, Arrays>;

/// A whole motion, run without the interpreter's lock. With limit options, the motion keeps the limits. With stack
/// options, the motion has several tasks.
Outcomes rollout(const Model& arm, const Path& path, const Scheme& scheme, const ArrayLike& q0, const ArrayLike& qd0,
                 double dt, double hold, const std::string& task, const py::object& options, const py::object& tasks) {
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), joint_vector(qd0, "qd0", arm.dof())};
  const std::optional<LimitOptions> limit_options = limit_options_of(options, arm);
  const std::optional<StackOptions> stack_options = stack_options_of(tasks, arm, path);
  const StackOptions* const stack = pointer_to(stack_options);
  const TimeGrid<double> grid(duration_of(path, stack), dt, hold);
  return visit_space(arm, task, stack != nullptr, [&](const auto* any, auto space) -> Outcomes {
    using Space = decltype(space);
    const AnyPath<Space> same = path.as<Space>();
    MotionArrays<Space> arrays(grid.samples(), arm.dof(), pointer_to(limit_options), stack);
    const Output<Space> output = arrays.output();
    const Motion<Space> motion{any, same, scheme, start, grid, stack};
    RolloutResult<kDynamic> result;
    {
      const py::gil_scoped_release others_may_run;
      result = limit_options ? motion.track(*limit_options, output) : motion.simulate(output);
    }
    return py::make_tuple(result.status, result.time, result.samples, arrays.all());
  });
}

/// A motion along a path in the least time. If the arm cannot follow the path, the time is the time of the path that
/// can be followed, and there are no samples; q is the last posture.
Outcomes fastest(const Model& arm, const Path& path, const Scheme& scheme, const ArrayLike& q0, double dt,
                 int intervals, const std::string& task, const py::object& limits, double tip_speed,
                 double tip_acceleration, const py::object& bounds, const py::object& tasks) {
  validation::require_positive("dt", dt);
  if (!(tip_speed > 0.0)) validation::fail("tip_speed", tip_speed, "positive");
  if (!(tip_acceleration > 0.0)) validation::fail("tip_acceleration", tip_acceleration, "positive");
  AnyBounds kept = bounds_of(arm, bounds);
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), JointVector::Zero(arm.dof())};
  const std::optional<StackOptions> stack_options = stack_options_of(tasks, arm, path);
  const StackOptions* const stack = pointer_to(stack_options);
  const double duration = duration_of(path, stack);
  const TimeGrid<double> nodes(duration, duration / intervals);
  return visit_space(arm, task, stack != nullptr, [&](const auto* any, auto space) -> Outcomes {
    using Space = decltype(space);
    const AnyPath<Space> same = path.as<Space>();
    RowMajor q(nodes.samples(), arm.dof());
    Output<Space> output;
    output.buffers.q = q.data();
    Motion<Space> motion{any, same, scheme, start, nodes, stack};
    const auto along = motion.simulate(output);
    if (failed(along.status)) {
      Arrays last;
      last["q"] = array_of(along.last.q);
      return py::make_tuple(along.status, along.time / duration, 0, last);
    }
    std::vector<JointVector> rows;
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
      rows.emplace_back(q.row(i).transpose());
      try {
        kept.require(rows.back());
      } catch (const std::invalid_argument& error) {
        validation::reject("path", " at the fraction ", static_cast<double>(i) / intervals, ": ", error.what());
      }
    }
    const auto joints = joint_spline<kDynamic>(rows, duration);
    const auto clock =
        motion.clock(joints, limits_of(arm, limits), kept, {dt, intervals, {tip_speed, tip_acceleration}});
    motion.grid = TimeGrid<double>(clock.duration(), dt);
    MotionArrays<Space> arrays(motion.grid.samples(), arm.dof(), nullptr, stack);
    motion.play(joints, clock, arrays.output());
    return py::make_tuple(along.status, motion.grid.duration(), motion.grid.samples(), arrays.all());
  });
}

}  // namespace

std::optional<LimitOptions> limit_options_of(const py::object& given, const Model& model) {
  if (given.is_none()) return std::nullopt;
  const auto number = [&](const char* name) { return py::cast<double>(given.attr(name)); };
  const py::object limits = given.attr("limits");
  LimitOptions limit_options{
      limits_of(model, limits),
      {1e-3, number("error_bound"), number("integral_gain"), number("integral_bound"), number("stall_time"),
       SingularDamping<>(number("singular_radius"), number("singular_brake")), number("null_damping")},
      bounds_of(model, given.attr("bounds"))};
  for (const py::handle each : given.attr("bounds")) {
    limit_options.keeps_clear = limit_options.keeps_clear || is_class(each, "clearance", "Clearance");
  }
  limit_options.options.recover_start = py::cast<bool>(given.attr("recover_start"));
  return limit_options;
}

std::optional<StackOptions> stack_options_of(const py::object& given, const Model& model, const Path& path) {
  if (given.is_none()) return std::nullopt;
  StackOptions options{read_stack(given.attr("stack"), model), {}, 0.0};
  const auto lead = [&](const std::string& name, const Path& each) {
    const StackTask& task = options.plan.follower(name);
    const auto index = static_cast<std::size_t>(&task - options.plan.tasks.data());
    if (task.kind == TaskKind::kPose) {
      options.paths.push_back({index, each.as<Pose>()});
    } else {
      options.paths.push_back({index, each.as<Position<3>>()});
    }
    options.duration = std::max(options.duration, each.duration());
  };
  lead(py::cast<std::string>(given.attr("task")), path);
  for (const auto& [name, each] : py::cast<py::dict>(given.attr("other_paths"))) {
    lead(py::cast<std::string>(name), py::cast<const Path&>(each));
  }
  return options;
}

void bind_sim(py::module_& m) {
  m.def("rollout", &rollout, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("qd0"),
        py::arg("dt"), py::arg("hold"), py::arg("task"), py::arg("limit_options") = py::none(),
        py::arg("stack_tasks") = py::none());
  m.def("fastest", &fastest, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("dt"),
        py::arg("intervals"), py::arg("task"), py::arg("limits"), py::arg("tip_speed"), py::arg("tip_acceleration"),
        py::arg("bounds"), py::arg("stack_tasks") = py::none());
}

}  // namespace fpbm::bindings
