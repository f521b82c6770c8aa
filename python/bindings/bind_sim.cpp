#include <pybind11/typing.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "motion.hpp"
#include "read.hpp"
#include "sources.hpp"
#include "sweep.hpp"

namespace fpbm::bindings {
namespace {

/// The arrays of a motion by name, one row per sample.
using Arrays = py::typing::Dict<py::str, py::array>;

/// Status, time of the last sample, number of samples, and arrays with this number of filled rows.
using Outcomes = py::typing::Tuple<Status, double, int, Arrays>;

using Schemes = std::vector<const Scheme*>;
using Chunk = py::typing::Tuple<py::array, py::typing::List<Arrays>>;

/// Ends all motions of a sweep, from any thread.
struct Stop {
  std::atomic<bool> flag{false};
};

/// Limit options from a LimitOptions of motion/simulation.py, or none.
std::optional<LimitOptions> limit_options_of(const py::object& given, const Model& model) {
  if (given.is_none()) return std::nullopt;
  const auto number = [&](const char* name) { return py::cast<double>(given.attr(name)); };
  LimitOptions limit_options{
      limits_of(model, given.attr("limits")),
      {1e-3, number("error_bound"), number("integral_gain"), number("integral_bound"), number("stall_time"),
       SingularDamping<>(number("singular_radius"), number("singular_brake")), number("null_damping")},
      bounds_of(model, given.attr("bounds"))};
  for (const py::handle each : given.attr("bounds")) {
    limit_options.keeps_clear = limit_options.keeps_clear || is_class(each, "clearance", "Clearance");
  }
  limit_options.options.recover_start = py::cast<bool>(given.attr("recover_start"));
  limit_options.keeps_path = py::cast<bool>(given.attr("keep_path"));
  limit_options.reserve = number("reserve");
  validation::require_non_negative("reserve", limit_options.reserve);
  return limit_options;
}

/// The tasks of a stack from a StackTasks of motion/simulation.py, or none. path: the path of the task with the name
/// given.task.
std::optional<StackOptions> stack_options_of(const py::object& given, const Model& model, const Path& path) {
  if (given.is_none()) return std::nullopt;
  StackOptions options{read_stack(given.attr("stack"), model), {}, 0.0};
  options.add(py::cast<std::string>(given.attr("task")), path);
  for (const auto& [name, each] : py::cast<py::dict>(given.attr("other_paths"))) {
    options.add(py::cast<std::string>(name), py::cast<const Path&>(each));
  }
  return options;
}

/// The options of motions. limit_options, stack_tasks: objects of motion/simulation.py, or None.
class MotionOptions {
 public:
  MotionOptions(const Model& model, const Path& path, double dt, double hold, const py::object& limit_options,
                const py::object& stack_tasks)
      : limits_(limit_options_of(limit_options, model)),
        stack_(stack_options_of(stack_tasks, model, path)),
        duration_(stack_ ? stack_->duration : path.duration()),
        grid_(keeps_path() ? dt : duration_, dt, hold) {}

  /// Null without limits.
  [[nodiscard]] const LimitOptions* limits() const noexcept { return limits_ ? &*limits_ : nullptr; }
  [[nodiscard]] bool keeps_path() const noexcept { return limits_ && limits_->keeps_path; }
  /// Duration of the path, or of the longest path of a stack [s].
  [[nodiscard]] double duration() const noexcept { return duration_; }
  /// Null without a stack.
  [[nodiscard]] const StackOptions* stack() const noexcept { return stack_ ? &*stack_ : nullptr; }
  [[nodiscard]] const TimeGrid<double>& grid() const noexcept { return grid_; }

 private:
  std::optional<LimitOptions> limits_;
  std::optional<StackOptions> stack_;
  double duration_;
  TimeGrid<double> grid_;
};

/// Arrays for a motion of n joints. limits and stack: null if the motion has none.
template <typename Space>
struct MotionArrays {
  MotionArrays(py::ssize_t samples, py::ssize_t n, const LimitOptions* limits, const StackOptions* stack) {
    using Row = std::vector<py::ssize_t>;
    const auto add = [&](const char* name, auto number, Row shape) {
      shape.insert(shape.begin(), samples);
      py::array_t<decltype(number)> array(shape);
      all[name] = array;
      return array.mutable_data();
    };
    const Row point = std::is_same_v<Space, Pose> ? Row{4, 4} : Row{Space::kSize};
    output.buffers = {add("t", 0.0, {}),
                      add("q", 0.0, {n}),
                      add("qd", 0.0, {n}),
                      add("qdd", 0.0, {n}),
                      add("x", 0.0, point),
                      add("x_ref", 0.0, point),
                      add("error", 0.0, {Space::kRows})};
    if (limits != nullptr) {
      output.scale = add("scale", 0.0, {});
      output.saturated = add("saturated", false, {n});
      if (limits->keeps_clear) output.clearance = add("clearance", 0.0, {});
      if (stack != nullptr) output.scales = add("scales", 0.0, {stack->plan.levels});
    }
    if (stack != nullptr) output.errors = add("task_errors", 0.0, {stack->plan.error_size()});
  }

  Arrays all;
  Output<Space> output;  ///< Pointers to the numbers of the arrays.
};

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// A whole motion, run without the interpreter's lock. With limit options, the motion keeps the limits. With stack
/// tasks, the motion has several tasks. kept: bound on the speed of the tip [m/s] and least duration [s] of a motion
/// that keeps its path.
Outcomes rollout(const Model& arm, const Path& path, const Scheme& given, const ArrayLike& q0, const ArrayLike& qd0,
                 double dt, double hold, const std::string& task, const py::object& limit_options,
                 const py::object& stack_tasks, const std::pair<double, double>& kept) {
  const Scheme scheme = given.on(arm);
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), joint_vector(qd0, "qd0", arm.dof())};
  const MotionOptions options(arm, path, dt, hold, limit_options, stack_tasks);
  return visit_space(arm, task, options.stack() != nullptr, [&](const auto* any, auto space) -> Outcomes {
    using Space = decltype(space);
    AnyPath<Space> same = path.as<Space>();
    std::optional<StackOptions> stack;
    if (options.stack() != nullptr) stack = *options.stack();
    Motion<Space> motion{any, same, scheme, start, options.grid(), stack ? &*stack : nullptr};
    if (options.keeps_path()) {
      const LimitOptions& limits = *options.limits();
      const auto [tip_speed, shortest] = kept;
      const FastestOptions fastest{dt, tip_speed, kUnbounded, limits.reserve};
      const Scheme damped = scheme.with_null_damping(limits.options.null_damping);
      const Motion<Space> planned{any, same, damped, start, options.grid(), motion.stack};
      motion.kept = planned.kept_motion(limits.limits, limits.bounds, options.duration(), shortest, fastest);
      same = AnyPath<Space>(TimedPath(same, motion.kept));
      motion.grid = TimeGrid<double>(same.duration(), motion.grid.dt(), hold);
      if (stack) {
        stack->duration = same.duration();
        for (TaskPath& each : stack->paths) each.keep(motion.kept);
      }
    }
    const MotionArrays<Space> arrays(motion.grid.samples(), arm.dof(), options.limits(), motion.stack);
    RolloutResult<kDynamic> result;
    {
      const py::gil_scoped_release others_may_run;
      result =
          options.limits() != nullptr ? motion.track(*options.limits(), arrays.output) : motion.simulate(arrays.output);
    }
    return py::make_tuple(result.status, result.time, result.samples, arrays.all);
  });
}

/// A motion along a path in the least time. end_speeds: speeds of the tip at the start and at the end [m/s]. If the arm
/// cannot follow the path, the time is the fraction of the path that can be followed, and there are no samples; q is
/// the last posture.
Outcomes fastest(const Model& arm, const Path& path, const Scheme& given, const ArrayLike& q0, double dt,
                 const std::string& task, const py::object& limits, double tip_speed, double tip_acceleration,
                 const py::object& bounds, const py::object& stack_tasks, const ClockEnds& end_speeds) {
  const Scheme scheme = given.on(arm);
  const FastestOptions options{dt, tip_speed, tip_acceleration, 0.0, end_speeds[0], end_speeds[1]};
  const std::array<bool, 2> moving = moves_at_ends(options);
  validation::require_positive("dt", dt);
  if (!(tip_speed > 0.0)) validation::fail("tip_speed", tip_speed, "positive");
  if (!(tip_acceleration > 0.0)) validation::fail("tip_acceleration", tip_acceleration, "positive");
  AnyBounds kept = bounds_of(arm, bounds);
  const State<kDynamic> start{joint_vector(q0, "q0", arm.dof()), JointVector::Zero(arm.dof())};
  std::optional<StackOptions> stack = stack_options_of(stack_tasks, arm, path);
  const double duration = stack ? stack->duration : path.duration();
  return visit_space(arm, task, stack.has_value(), [&](const auto* any, auto space) -> Outcomes {
    using Space = decltype(space);
    AnyPath<Space> same = path.as<Space>();
    Motion<Space> motion{any, same, scheme, start, TimeGrid<double>(duration, duration), stack ? &*stack : nullptr};
    JointPath<kDynamic> along = motion.joint_path(duration);
    if (!along.joints) {
      Arrays last;
      last["q"] = array_of(along.result.last.q);
      return py::make_tuple(along.result.status, along.result.time / duration, 0, last);
    }
    if (moving[0] || moving[1]) {
      const MovingEnds ends(same, moving);
      along.joints = moving_joints(*along.joints, ends);
      same = AnyPath<Space>(ends);
      if (stack) {
        std::visit([&](auto& own) { own = std::decay_t<decltype(own)>(MovingEnds(own, moving)); },
                   stack->paths.front().path);
      }
    }
    for (const double p : along.joints->times()) require_posture(kept, along.joints->at(p).x, p / duration);
    const auto clock = motion.clock(*along.joints, limits_of(arm, limits), kept, options);
    motion.grid = TimeGrid<double>(clock.duration(), dt);
    const MotionArrays<Space> arrays(motion.grid.samples(), arm.dof(), nullptr, motion.stack);
    motion.play(*along.joints, clock, arrays.output);
    return py::make_tuple(along.result.status, motion.grid.duration(), motion.grid.samples(), arrays.all);
  });
}

/// One start or several starts as rows.
Array starts(const ArrayLike& q0s, int dof) {
  if (dimensions(q0s) < 2) return array_of(RowMajor(joint_vector(q0s, "q0s", dof).transpose()));
  if (dimensions(q0s) > 2) {
    validation::reject("q0s", ": must have shape (n,) or (K, n), got shape " + shape_text(py::array::ensure(q0s)));
  }
  const auto rows = real_array(q0s, "q0s", 2);
  if (rows.shape(0) == 0) validation::reject("q0s", ": must have at least one row");
  validation::require_size("a row of q0s", rows.shape(1), dof);
  return array_of(matrix(q0s, "q0s", rows.shape(0), dof));
}

JointVector row(const Array& rows, py::ssize_t i) {
  return Eigen::Map<const Eigen::VectorXd>(rows.data(i, 0), rows.shape(1));
}

/// Checks all arguments of a sweep. Returns the starts as rows, and the number of samples of a motion.
py::typing::Tuple<Array, int> check_sweep(const Model& arm, const Path& path, const Schemes& schemes,
                                          const ArrayLike& q0s, double dt, double hold, const std::string& task,
                                          const py::object& limit_options, const py::object& stack_tasks) {
  const Array rows = starts(q0s, arm.dof());
  const MotionOptions options(arm, path, dt, hold, limit_options, stack_tasks);
  visit_space(arm, task, options.stack() != nullptr, [&](const auto* any, auto space) {
    using Space = decltype(space);
    const AnyPath<Space> same = path.as<Space>();
    const JointVector rest = JointVector::Zero(arm.dof());
    for (std::size_t i = 0; i < schemes.size(); ++i) {
      // Only the check of a start against limits depends on the row. All other checks depend on the scheme.
      const py::ssize_t checked = options.limits() != nullptr ? rows.shape(0) : 1;
      for (py::ssize_t k = 0; k < checked; ++k) {
        try {
          const Scheme scheme = schemes[i]->on(arm);
          Motion<Space>{any, same, scheme, {row(rows, k), rest}, options.grid(), options.stack()}.require(
              options.limits());
        } catch (const ParameterError& wrong) {
          const std::string which = options.limits() != nullptr ? ", q0s[" + std::to_string(k) + "]" : "";
          throw ParameterError("schemes", static_cast<int>(i), wrong.value(),
                               "schemes[" + std::to_string(i) + "]" + which + ": " + wrong.what());
        }
      }
    }
  });
  return py::make_tuple(rows, options.grid().samples());
}

/// Outcomes of motions that were not run.
py::array not_run(py::ssize_t count) {
  py::array_t<Outcome> outcomes(count);
  std::fill_n(outcomes.mutable_data(), count, Outcome::of_nothing());
  return outcomes;
}

/// Runs schemes[which[i]] from q0s[i] for every i, without the interpreter's lock.
Chunk sweep_chunk(const Arm& arm, const Path& path, const Schemes& schemes, const std::vector<std::size_t>& which,
                  const ArrayLike& q0s, double dt, double hold, const std::string& task, bool motions,
                  const py::object& limit_options, const py::object& stack_tasks, const Stop& stop) {
  const Array rows = starts(q0s, arm.dof());
  if (static_cast<std::size_t>(rows.shape(0)) != which.size()) {
    throw std::invalid_argument("which and q0s: must have equal lengths");
  }
  const MotionOptions options(arm, path, dt, hold, limit_options, stack_tasks);
  py::array_t<Outcome> outcomes(rows.shape(0));
  Outcome* const into = outcomes.mutable_data();
  return arm.visit(task, [&](const auto&, auto space) -> Chunk {
    using Space = decltype(space);
    const AnyPath<Space> same = path.as<Space>();
    std::vector<Job<Space>> jobs;
    std::deque<Scheme> with_dynamics;
    py::typing::List<Arrays> arrays;
    for (std::size_t i = 0; i < which.size(); ++i) {
      const Scheme* scheme = schemes.at(which[i]);
      if (scheme->uses_dynamics) scheme = &with_dynamics.emplace_back(scheme->on(arm));
      jobs.push_back({scheme, row(rows, static_cast<py::ssize_t>(i))});
      if (motions) {
        const MotionArrays<Space> whole(options.grid().samples(), arm.dof(), options.limits(), options.stack());
        jobs.back().output = whole.output;
        arrays.append(whole.all);
      }
    }
    {
      const py::gil_scoped_release others_may_run;
      const Sweep<Space> sweep{arm, same, options.grid(), options.limits(), options.stack(), stop.flag};
      sweep.run(jobs, selected_lanes, into);
    }
    return py::make_tuple(outcomes, arrays);
  });
}

/// Kinds of lane code that this processor can run, the best kind first.
std::vector<std::string> processor_kinds() {
  std::vector<std::string> kinds;
#if defined(__x86_64__) && defined(__GNUC__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (avx2 && avx512) kinds.emplace_back("avx512");
  if (avx2) kinds.emplace_back("avx2");
#endif
  return kinds;
}

/// Selects the lane code, or none, and returns the number of motions that run side by side.
int use_lanes(const py::object& code) {
  selected_lanes = code.is_none() ? nullptr : static_cast<const LaneCode*>(py::capsule(code).get_pointer());
  return selected_lanes == nullptr ? 1 : selected_lanes->lanes;
}

}  // namespace

void bind_sim(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(MotionSummary<>, max_error, max_orientation_error, peak_velocity, final_velocity,
                       peak_acceleration, final_acceleration, manipulability);
  PYBIND11_NUMPY_DTYPE(Outcome, status, samples, time, summary);
  py::class_<Stop>(m, "Stop", "Stops all motions of a sweep in this process within a sample.")
      .def(py::init<>())
      .def(
          "set", [](Stop& stop) { stop.flag.store(true, std::memory_order_relaxed); }, "Callable from any thread.");
  const auto none = py::none();
  m.def("rollout", &rollout, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("qd0"),
        py::arg("dt"), py::arg("hold"), py::arg("task"), py::arg("limit_options") = none, py::arg("stack_tasks") = none,
        py::arg("kept") = std::pair(kUnbounded, 0.0));
  m.def("fastest", &fastest, py::arg("arm"), py::arg("path"), py::arg("scheme"), py::arg("q0"), py::arg("dt"),
        py::arg("task"), py::arg("limits"), py::arg("tip_speed"), py::arg("tip_acceleration"), py::arg("bounds"),
        py::arg("stack_tasks") = none, py::arg("end_speeds") = ClockEnds{});
  m.def("processor_kinds", &processor_kinds);
  m.def("use_lanes", &use_lanes, py::arg("code"));
  m.def("check_sweep", &check_sweep, py::arg("arm"), py::arg("path"), py::arg("schemes"), py::arg("q0s"), py::arg("dt"),
        py::arg("hold"), py::arg("task"), py::arg("limit_options") = none, py::arg("stack_tasks") = none);
  m.def("not_run", &not_run, py::arg("count"));
  m.def("sweep_chunk", &sweep_chunk, py::arg("arm"), py::arg("path"), py::arg("schemes"), py::arg("which"),
        py::arg("q0s"), py::arg("dt"), py::arg("hold"), py::arg("task"), py::arg("motions"), py::arg("limit_options"),
        py::arg("stack_tasks"), py::arg("stop"));
}

}  // namespace fpbm::bindings
