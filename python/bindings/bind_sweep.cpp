#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include "motion_arrays.hpp"
#include "path.hpp"
#include "sweep.hpp"

namespace fpbm::bindings {
namespace {

/// Ends all motions of a sweep, from any thread.
struct Stop {
  std::atomic<bool> flag{false};
};

using Schemes = std::vector<const Scheme*>;
using Chunk = py::typing::Tuple<py::array, py::typing::List<Arrays>>;

const LaneCode* selected = nullptr;

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
                                          const py::object& options, const py::object& tasks) {
  const Array rows = starts(q0s, arm.dof());
  const std::optional<LimitOptions> limit_options = limit_options_of(options, arm);
  const std::optional<StackOptions> stack_options = stack_options_of(tasks, arm, path);
  const StackOptions* const stack = pointer_to(stack_options);
  const TimeGrid<double> grid(duration_of(path, stack), dt, hold);
  visit_space(arm, task, stack != nullptr, [&](const auto* any, auto space) {
    using Space = decltype(space);
    const AnyPath<Space> same = path.as<Space>();
    const JointVector rest = JointVector::Zero(arm.dof());
    for (std::size_t i = 0; i < schemes.size(); ++i) {
      // Only the check of a start against limits depends on the row. All other checks depend on the scheme.
      const py::ssize_t checked = limit_options ? rows.shape(0) : 1;
      for (py::ssize_t k = 0; k < checked; ++k) {
        try {
          Motion<Space>{any, same, *schemes[i], {row(rows, k), rest}, grid, stack}.require(pointer_to(limit_options));
        } catch (const ParameterError& wrong) {
          const std::string which = limit_options ? ", q0s[" + std::to_string(k) + "]" : "";
          throw ParameterError("schemes", static_cast<int>(i), wrong.value(),
                               "schemes[" + std::to_string(i) + "]" + which + ": " + wrong.what());
        }
      }
    }
  });
  return py::make_tuple(rows, grid.samples());
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
                  const py::object& options, const py::object& tasks, const Stop& stop) {
  const Array rows = starts(q0s, arm.dof());
  if (static_cast<std::size_t>(rows.shape(0)) != which.size()) {
    throw std::invalid_argument("which and q0s: must have equal lengths");
  }
  const TimeGrid<double> grid(path.duration(), dt, hold);
  const std::optional<LimitOptions> limit_options = limit_options_of(options, arm);
  const std::optional<StackOptions> stack_options = stack_options_of(tasks, arm, path);
  const StackOptions* const stack = pointer_to(stack_options);
  py::array_t<Outcome> outcomes(rows.shape(0));
  Outcome* const into = outcomes.mutable_data();
  return arm.visit(task, [&](const auto&, auto space) -> Chunk {
    using Space = decltype(space);
    const AnyPath<Space> same = path.as<Space>();
    std::vector<Job<Space>> jobs;
    std::vector<MotionArrays<Space>> whole;
    for (std::size_t i = 0; i < which.size(); ++i) {
      jobs.push_back({schemes.at(which[i]), row(rows, static_cast<py::ssize_t>(i))});
      if (motions) {
        jobs.back().output = whole.emplace_back(grid.samples(), arm.dof(), pointer_to(limit_options), stack).output();
      }
    }
    {
      const py::gil_scoped_release others_may_run;
      sweep(arm, same, grid, jobs, pointer_to(limit_options), stack, selected, stop.flag, into);
    }
    py::typing::List<Arrays> arrays;
    for (const MotionArrays<Space>& each : whole) arrays.append(each.all());
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
  selected = code.is_none() ? nullptr : static_cast<const LaneCode*>(py::capsule(code).get_pointer());
  return selected == nullptr ? 1 : selected->lanes;
}

}  // namespace

const LaneCode* lane_code() noexcept {
  return selected;
}

void bind_sweep(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(MotionSummary<>, max_error, max_orientation_error, peak_velocity, final_velocity,
                       peak_acceleration, final_acceleration, manipulability);
  PYBIND11_NUMPY_DTYPE(Outcome, status, samples, time, summary);
  py::class_<Stop>(m, "Stop", "Stops all motions of a sweep in this process within a sample.")
      .def(py::init<>())
      .def(
          "set", [](Stop& stop) { stop.flag.store(true, std::memory_order_relaxed); }, "Callable from any thread.");
  m.def("processor_kinds", &processor_kinds);
  m.def("use_lanes", &use_lanes, py::arg("code"));
  m.def("check_sweep", &check_sweep, py::arg("arm"), py::arg("path"), py::arg("schemes"), py::arg("q0s"), py::arg("dt"),
        py::arg("hold"), py::arg("task"), py::arg("limit_options") = py::none(), py::arg("stack_tasks") = py::none());
  m.def("not_run", &not_run, py::arg("count"));
  m.def("sweep_chunk", &sweep_chunk, py::arg("arm"), py::arg("path"), py::arg("schemes"), py::arg("which"),
        py::arg("q0s"), py::arg("dt"), py::arg("hold"), py::arg("task"), py::arg("motions"), py::arg("limit_options"),
        py::arg("stack_tasks"), py::arg("stop"));
}

}  // namespace fpbm::bindings
