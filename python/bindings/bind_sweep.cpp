#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "lanes.hpp"
#include "motion_arrays.hpp"
#include "py_arm.hpp"
#include "sweep.hpp"

namespace fpbm::bindings {
namespace {

/// A word to all who run motions, from any thread.
struct Stop {
  std::atomic<bool> flag{false};
};

using Schemes = std::vector<const PyScheme*>;
using Motions = py::typing::List<Arrays>;
using Chunk = py::typing::Tuple<py::array, Motions>;

/// Starts as rows, from one or from many.
Array starts(const ArrayLike& q0s, int dof) {
  const auto any = py::array::ensure(q0s);
  PyErr_Clear();
  if (any && any.ndim() > 2) {
    throw std::invalid_argument("q0s: must have shape (n,) or (K, n), got shape " +
                                py::cast<std::string>(py::str(any.attr("shape"))));
  }
  if (!any || any.ndim() < 2) {
    const Joints q0 = joint_vector(q0s, "q0s", dof);
    Array row({py::ssize_t{1}, py::ssize_t{dof}});
    std::copy_n(q0.data(), dof, row.mutable_data());
    return row;
  }
  const auto rows = real_array(q0s, "q0s", 2);
  if (rows.shape(0) == 0) throw std::invalid_argument("q0s: must have one row at least");
  validation::require_size("a row of q0s", rows.shape(1), dof);
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    for (py::ssize_t j = 0; j < dof; ++j) validation::require_finite(validation::element("q0s", i, j), rows.at(i, j));
  }
  return rows;
}

/// Checks all that a sweep is made of, and returns its starts as rows and the samples of each motion.
py::typing::Tuple<Array, int> check_sweep(const PyArm& arm, const PyPath& path, const Schemes& schemes,
                                          const ArrayLike& q0s, double dt, double hold, const std::string& task) {
  const Array rows = starts(q0s, arm.dof());
  const TimeGrid<double> grid(path.duration(), dt, hold);
  arm.visit(task, [&](const auto& model) {
    using Space = typename std::decay_t<decltype(model)>::Space;
    require_redundant(Space::kRows, arm.dof());
    (void)path.as<Space>();
    for (std::size_t i = 0; i < schemes.size(); ++i) {
      try {
        model.require(*schemes[i]);
      } catch (const std::invalid_argument& wrong) {
        throw std::invalid_argument("schemes[" + std::to_string(i) + "]: " + wrong.what());
      }
    }
  });
  return py::make_tuple(rows, grid.samples());
}

/// Outcomes of motions that are yet to be run.
py::array not_run(py::ssize_t count) {
  py::array_t<Outcome> outcomes(count);
  std::fill_n(outcomes.mutable_data(), count, Outcome::of_nothing());
  return outcomes;
}

/// Runs schemes[which[i]] from q0s[i] for every i, without the interpreter's lock.
template <typename Space>
Chunk sweep_task(const TaskModel<Space>& model, const AnyPath<Space>& path, const Schemes& schemes,
                 const std::vector<std::size_t>& which, const Array& q0s, const TimeGrid<double>& grid, bool motions,
                 const Stop& stop) {
  const py::ssize_t n = q0s.shape(1);
  std::vector<Job<Space>> jobs;
  std::vector<MotionArrays<Space>> arrays;
  for (std::size_t i = 0; i < which.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    jobs.push_back({schemes.at(which[i]), Eigen::Map<const Eigen::VectorXd>(q0s.data(row, 0), n)});
    if (motions) jobs.back().buffers = arrays.emplace_back(grid.samples(), n).buffers();
  }
  py::array_t<Outcome> outcomes(static_cast<py::ssize_t>(jobs.size()));
  Outcome* const into = outcomes.mutable_data();
  {
    const py::gil_scoped_release others_may_run;
    sweep(model, path, grid, jobs, stop.flag, into);
  }
  Motions whole;
  for (const MotionArrays<Space>& each : arrays) whole.append(each.arrays());
  return py::make_tuple(outcomes, whole);
}

Chunk sweep_chunk(const PyArm& arm, const PyPath& path, const Schemes& schemes, const std::vector<std::size_t>& which,
                  const ArrayLike& q0s, double dt, double hold, const std::string& task, bool motions,
                  const Stop& stop) {
  const Array rows = starts(q0s, arm.dof());
  if (static_cast<std::size_t>(rows.shape(0)) != which.size()) {
    throw std::invalid_argument("which and q0s: must be of one length");
  }
  const TimeGrid<double> grid(path.duration(), dt, hold);
  return arm.visit(task, [&](const auto& model) {
    using Space = typename std::decay_t<decltype(model)>::Space;
    return sweep_task<Space>(model, path.as<Space>(), schemes, which, rows, grid, motions, stop);
  });
}

/// Kinds of processor that this one is of, the best first, of those that there may be code in lanes for.
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

}  // namespace

void bind_sweep(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(MotionSummary<>, max_error, max_orientation_error, peak_velocity, final_velocity,
                       peak_acceleration, final_acceleration, manipulability);
  PYBIND11_NUMPY_DTYPE(Outcome, status, samples, time, summary);
  py::class_<Stop>(m, "Stop", "A word to all motions of a sweep in this process: set() ends them within a sample.")
      .def(py::init<>())
      .def(
          "set", [](Stop& stop) { stop.flag.store(true, std::memory_order_relaxed); }, "From any thread.");
  m.def("processor_kinds", &processor_kinds);
  m.def(
      "use_lanes",
      [](const py::object& code) {
        use_lane_code(code.is_none() ? nullptr : static_cast<const LaneCode*>(py::capsule(code).get_pointer()));
        return lane_code() == nullptr ? 1 : lane_code()->lanes;
      },
      py::arg("code"));
  m.def("check_sweep", &check_sweep, py::arg("arm"), py::arg("path"), py::arg("schemes"), py::arg("q0s"), py::arg("dt"),
        py::arg("hold"), py::arg("task"));
  m.def("not_run", &not_run, py::arg("count"));
  m.def("sweep_chunk", &sweep_chunk, py::arg("arm"), py::arg("path"), py::arg("schemes"), py::arg("which"),
        py::arg("q0s"), py::arg("dt"), py::arg("hold"), py::arg("task"), py::arg("motions"), py::arg("stop"));
}

}  // namespace fpbm::bindings
