#include <pybind11/typing.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "lanes.hpp"
#include "postures.hpp"
#include "read.hpp"

namespace fpbm::bindings {
namespace {

/// A posture in Python.
struct PyPosture : AnyPosture {
  std::optional<double> rank_value = {};  ///< Set by PyInverse::solve_all().
};

/// The options of InverseKinematics in Python.
struct PyInverseOptions {
  std::string task;
  py::object stack;
  py::object limits;
  py::tuple bounds;
  InverseOptions<> search;

  /// Whether the options are the same objects and equal numbers.
  [[nodiscard]] bool is_same(const PyInverseOptions& other) const {
    const auto same = [](const py::handle& a, const py::handle& b) { return a.is(b); };
    return task == other.task && stack.is(other.stack) && limits.is(other.limits) &&
           search.tolerance == other.search.tolerance && search.starts == other.search.starts &&
           search.seed == other.search.seed &&
           std::equal(bounds.begin(), bounds.end(), other.bounds.begin(), other.bounds.end(), same);
  }
};

/// The bounds as a tuple. Throws std::invalid_argument unless they are a sequence.
py::tuple tuple_of(const py::object& bounds) {
  if (!py::isinstance<py::iterable>(bounds)) reject_type(bounds, "bounds", kBoundsDemand);
  return py::tuple(bounds);
}

/// Postures for several targets.
struct PyPostures {
  Array q;
  py::array_t<bool> solved;
  Array error;
  py::array_t<int> starts;
  std::vector<Status> status;
};

/// The point of a task space from Space::kSize numbers. A rotation with errors up to kLargest is replaced by the
/// nearest rotation. name() returns the name of the target. Throws std::invalid_argument.
template <typename Space, typename Name>
[[nodiscard]] typename Space::template Point<double> target_at(const double* numbers, const Name& name) {
  constexpr bool kMatrix = std::is_same_v<Space, Pose>;
  for (int i = 0; i < Space::kSize; ++i) {
    if (std::isfinite(numbers[i])) continue;
    validation::fail(kMatrix ? validation::element(name(), i / 4, i % 4) : validation::element(name(), i), numbers[i],
                     "finite");
  }
  if constexpr (kMatrix) {
    constexpr double kLargest = 1e-3;
    Eigen::Matrix4d H = Eigen::Map<const RowMajor>(numbers, 4, 4);
    const Matrix<3, 3> R = H.topLeftCorner<3, 3>();
    const double error = (R.transpose() * R - Matrix<3, 3>::Identity()).cwiseAbs().maxCoeff();
    if (!(error <= kLargest)) {
      validation::fail(name() + ".R's largest error of R'R", error, "at most 0.001: must be a rotation matrix");
    }
    H.topLeftCorner<3, 3>() = nearest_rotation(nearest_rotation(R));
    return transform_of(H, name);
  } else {
    return point_at<Space>(numbers, name);
  }
}

/// Targets of a task in an array: `count` targets, or one target. Throws std::invalid_argument.
template <typename Space>
[[nodiscard]] std::vector<typename Space::template Point<double>> points_of(const py::object& given,
                                                                            std::optional<py::ssize_t> count,
                                                                            const std::string& name) {
  constexpr bool kMatrix = std::is_same_v<Space, Pose>;
  const auto array = real_array(ArrayLike(given), name.c_str(), (kMatrix ? 2 : 1) + (count ? 1 : 0));
  const py::ssize_t last = array.shape(array.ndim() - 1);
  if (array.size() != count.value_or(1) * Space::kSize || (kMatrix && last != 4)) {
    const std::string wanted = kMatrix ? "(4, 4)" : "(" + std::to_string(Space::kSize) + ",)";
    validation::reject(name, ": must have shape " + wanted + ", got shape " + shape_text(array));
  }
  std::vector<typename Space::template Point<double>> points;
  points.reserve(static_cast<std::size_t>(count.value_or(1)));
  for (py::ssize_t i = 0; i < count.value_or(1); ++i) {
    points.push_back(target_at<Space>(array.data() + i * Space::kSize, [&] {
      return count ? validation::element(name, i) : validation::Argument(name);
    }));
  }
  return points;
}

/// Number of targets in an array of targets of the given dimensions, or none for one target.
[[nodiscard]] std::optional<py::ssize_t> count_of(const py::handle& given, int dimensions) {
  const auto array = py::array::ensure(given);
  PyErr_Clear();
  if (!array || array.ndim() != dimensions + 1) return std::nullopt;
  return array.shape(0);
}

/// Targets of the tip of an arm.
template <typename Space_>
struct TipTargets {
  using Space = Space_;
  using Point = typename Space::template Point<double>;

  std::unique_ptr<PostureSolver<Space>> solver;

  [[nodiscard]] static std::optional<py::ssize_t> count(const py::object& given) {
    return count_of(given, std::is_same_v<Space, Pose> ? 2 : 1);
  }
  /// The target, or `count` targets.
  [[nodiscard]] static std::vector<Point> read(const py::object& given, std::optional<py::ssize_t> count,
                                               const std::vector<JointVector>&) {
    return points_of<Space>(given, count, "target");
  }
};

/// Targets of the tasks of a stack: a dictionary by task name. With `is_tip`, a target of the only task.
struct StackTargets {
  using Space = AnyStack::Space;
  using Point = AnyStack::Point;

  std::unique_ptr<PostureSolver<Space>> solver;
  StackPlan plan;
  Clearance<kDynamic> clearance;
  bool is_tip = false;

  [[nodiscard]] std::optional<py::ssize_t> count(const py::object& given) const {
    std::optional<py::ssize_t> several;
    for (const auto& [task, target] : parts(given)) {
      const bool is_matrix = task->kind == TaskKind::kPose || task->kind == TaskKind::kOrientation;
      const auto count = count_of(target, is_matrix ? 2 : 1);
      if (count && several.value_or(*count) != *count) {
        validation::fail(validation::Argument("number of targets of '") + task->name + "'", static_cast<int>(*count),
                         "equal to the number of the other targets = ", static_cast<int>(*several));
      }
      if (count) several = count;
    }
    return several;
  }

  /// Tasks without a target in the dictionary keep the target of the stack or, without one, their point at the start.
  [[nodiscard]] std::vector<Point> read(const py::object& given, std::optional<py::ssize_t> count,
                                        const std::vector<JointVector>& starts) const {
    const auto given_parts = parts(given);
    std::vector<Point> points;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      auto reference = Reference<Space>::hold(solver->tip(starts[i]));
      for (std::size_t k = 0; k < plan.tasks.size(); ++k) {
        if (plan.targets[k]) plan.tasks[k].put(*plan.targets[k], reference);
      }
      for (const auto& [task, target] : given_parts) {
        const py::object one = count ? py::object(target[py::int_(i)]) : target;
        task->put(of_task(*task, one), reference);
      }
      points.push_back(reference.x);
    }
    return points;
  }

 private:
  [[nodiscard]] std::vector<std::pair<const StackTask*, py::object>> parts(const py::object& given) const {
    if (is_tip) return {{&plan.tasks.front(), given}};
    if (!py::isinstance<py::dict>(given)) reject_type(given, "target", "a dictionary of targets by task name");
    std::vector<std::pair<const StackTask*, py::object>> parts;
    for (const auto& [name, target] : py::cast<py::dict>(given)) {
      parts.emplace_back(&plan.task(py::cast<std::string>(name)), py::reinterpret_borrow<py::object>(target));
    }
    return parts;
  }
  [[nodiscard]] static StackTarget of_task(const StackTask& task, const py::object& given) {
    if (task.kind == TaskKind::kPose && !py::isinstance<py::tuple>(given)) {
      return {points_of<Pose>(given, std::nullopt, task.name)[0], {}, JointVector::Zero(6), JointVector::Zero(6)};
    }
    return read_target(task, given);
  }
};

using AnyTargets = std::variant<TipTargets<Position<2>>, TipTargets<PlanarPose>, TipTargets<Position<3>>,
                                TipTargets<Pose>, StackTargets>;

/// Solver in lanes for the pose of a chain of six or seven joints, or null.
template <int N>
std::unique_ptr<PostureSolver<Pose>> in_lanes(const Arm& arm, const InverseOptions<>& options,
                                              const JointLimits<kDynamic>& limits) {
  const auto* chain = std::get_if<Chain<>>(&arm.source);
  if (selected_lanes == nullptr || chain == nullptr || arm.dof() != N || chain->joints.size() != N) return nullptr;
  return std::get<PosturesInLanes<N>>(selected_lanes->postures)(
      *chain, options, {limits.lower, limits.upper, limits.velocity, limits.acceleration});
}

/// The task of the tip of an arm in space as a plan of one task.
[[nodiscard]] StackPlan plan_of_tip(const Model& model, bool is_pose) {
  const auto [link, offset] = model.frame("tip");
  const auto kind = is_pose ? TaskKind::kPose : TaskKind::kPosition;
  AnyFrameTask::Selection all{};
  all.fill(true);
  const AnyFrameTask tip(is_pose ? FrameCoordinates::kPose : FrameCoordinates::kPosition, LinkFrame<>(link, offset),
                         TaskGains<>(1.0, 1.0), all, false);
  const AnyLevel none(AnyFrameTask{}, AnyFrameTask{}, AnyPostureTask{});
  const AnyStack stack(AnyLevel(tip, AnyFrameTask{}, AnyPostureTask{}), none, none, none);
  return {model.tree, {{"target", kind, 0, is_pose ? 6 : 3, {}}}, {std::nullopt}, 1, stack, stack};
}

AnyTargets targets_of(const Model& model, const PyInverseOptions& given, const JointLimits<kDynamic>& limits) {
  const auto of_stack = [&](const StackPlan& plan, bool is_tip) -> AnyTargets {
    AnyBounds bounds = bounds_of(model, given.bounds);
    return StackTargets{posture_solver(model.tree, plan.velocity, given.search, limits, bounds), plan,
                        bounds.clearance(), is_tip};
  };
  if (!given.stack.is_none()) return of_stack(read_stack(given.stack, model), false);
  const auto* arm = dynamic_cast<const Arm*>(&model);
  if (arm == nullptr) validation::reject("stack", ": must be given for a Robot, because a Robot has several tips");
  return arm->visit(given.task, [&](const auto& any, auto space) -> AnyTargets {
    using Space = decltype(space);
    if (!given.bounds.empty()) {
      if (model.planar) validation::reject("bounds", ": a planar arm needs a stack: give stack=fp.Stack(…)");
      return of_stack(plan_of_tip(model, Space::kTurns > 0), true);
    }
    if constexpr (std::is_same_v<Space, Pose>) {
      if (auto seven = in_lanes<7>(*arm, given.search, limits)) return TipTargets<Pose>{std::move(seven)};
      if (auto six = in_lanes<6>(*arm, given.search, limits)) return TipTargets<Pose>{std::move(six)};
    }
    return TipTargets<Space>{posture_solver<Space>(any, given.search, limits)};
  });
}

class PyInverse {
 public:
  PyInverse(const Model& model, const PyInverseOptions& options)
      : options_(options), limits_(limits_of(model, options.limits)), any_(targets_of(model, options, limits_)) {}

  [[nodiscard]] const PyInverseOptions& options() const noexcept { return options_; }

  /// A posture for a target, or an array of postures for several targets.
  [[nodiscard]] std::variant<PyPosture, PyPostures> solve(const py::object& target, const OptionalArray& start) {
    return std::visit(
        [&](auto& of) -> std::variant<PyPosture, PyPostures> {
          if (const auto count = of.count(target)) return solve_many(of, target, *count, start);
          const std::vector<JointVector> starts{start_of(start)};
          const auto points = of.read(target, std::nullopt, starts);
          const py::gil_scoped_release others_may_run;
          const std::lock_guard lock(mutex_);
          return PyPosture{of.solver->solve(points[0], starts[0])};
        },
        any_);
  }

  /// Distinct postures, sorted by rank. Postures with equal values are sorted by the distance from the start.
  [[nodiscard]] std::vector<PyPosture> solve_all(const py::object& target, const OptionalArray& start, int count,
                                                 const std::string& rank) {
    if (count < 1) validation::fail("count", count, "at least 1");
    const std::vector<JointVector> starts{start_of(start)};
    const JointVector& q0 = starts[0];
    std::vector<PyPosture> found;
    std::visit(
        [&](auto& of) {
          const auto value = value_of(of, rank, q0);
          const auto points = of.read(target, std::nullopt, starts);
          const py::gil_scoped_release others_may_run;
          const std::lock_guard lock(mutex_);
          of.solver->search(points[0], q0, [&](const AnyPosture& posture) {
            if (std::none_of(found.begin(), found.end(), [&](const auto& known) { return is_same(known, posture); })) {
              found.push_back({posture, value(posture.q)});
            }
            return false;
          });
        },
        any_);
    const double sign = rank == "distance" ? 1.0 : -1.0;
    const auto place = [&](const PyPosture& one) { return std::pair(sign * *one.rank_value, (one.q - q0).norm()); };
    std::sort(found.begin(), found.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
    found.erase(found.begin() + std::min(static_cast<std::ptrdiff_t>(found.size()), std::ptrdiff_t{count}),
                found.end());
    return found;
  }

 private:
  /// Largest difference of equal postures [rad or m].
  static constexpr double kSame = 1e-3;

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(limits_.lower.size()); }

  /// Two postures with differences of whole turns are the same.
  [[nodiscard]] bool is_same(const AnyPosture& a, const AnyPosture& b) const noexcept {
    for (Eigen::Index i = 0; i < a.q.size(); ++i) {
      const double difference = std::abs(a.q(i) - b.q(i));
      const bool turned = limits_.upper(i) - limits_.lower(i) >= kTwoPi && std::abs(difference - kTwoPi) <= kSame;
      if (difference > kSame && !turned) return false;
    }
    return true;
  }

  /// Smallest distance from an end of a range, as a fraction of the range. Joints without two ends do not count.
  [[nodiscard]] double range_gap(const JointVector& q) const noexcept {
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double range = limits_.upper(i) - limits_.lower(i);
      const bool counts = range > 0.0 && std::isfinite(range);
      if (counts) least = std::min(least, std::min(q(i) - limits_.lower(i), limits_.upper(i) - q(i)) / range);
    }
    return least;
  }
  /// The value of a posture by which solve_all() ranks. Throws std::invalid_argument.
  template <typename Targets_>
  [[nodiscard]] std::function<double(const JointVector&)> value_of(const Targets_& of, const std::string& rank,
                                                                   const JointVector& start) const {
    if (rank == "distance") return [&](const JointVector& q) { return (q - start).norm(); };
    if (rank == "manipulability") return [&](const JointVector& q) { return of.solver->manipulability(q); };
    if (rank == "ranges") return [this](const JointVector& q) { return range_gap(q); };
    if (rank != "clearance") {
      validation::reject("rank", " = '" + rank + "': must be 'distance', 'manipulability', 'ranges' or 'clearance'");
    }
    if constexpr (std::is_same_v<Targets_, StackTargets>) {
      if (!of.clearance.empty()) return [&](const JointVector& q) { return nearest_at(of.clearance, q)->distance; };
    }
    validation::reject("rank", " = 'clearance': needs a Clearance that checks a pair: give bounds=[fp.Clearance(…)]");
  }

  /// The start, or the middle of the ranges.
  [[nodiscard]] JointVector start_of(const OptionalArray& given) const {
    if (given) return joint_vector(*given, "start", dof());
    return entrywise(limits_.lower, [&](Eigen::Index i) {
      const double middle = (limits_.lower(i) + limits_.upper(i)) / 2.0;
      return std::isfinite(middle) ? middle : std::min(std::max(0.0, limits_.lower(i)), limits_.upper(i));
    });
  }
  /// A start for each target.
  [[nodiscard]] std::vector<JointVector> starts_of(const OptionalArray& given, py::ssize_t count) const {
    if (!given || dimensions(*given) != 2) return std::vector(static_cast<std::size_t>(count), start_of(given));
    const auto rows = real_array(*given, "start", 2);
    if (rows.shape(0) != count) {
      validation::fail("start's number of rows", static_cast<int>(rows.shape(0)),
                       "equal to the number of targets = ", static_cast<int>(count));
    }
    const Eigen::MatrixXd all = matrix(*given, "start", count, dof());
    std::vector<JointVector> starts;
    for (Eigen::Index i = 0; i < all.rows(); ++i) starts.emplace_back(all.row(i).transpose());
    return starts;
  }

  template <typename Targets_>
  [[nodiscard]] auto clone(Targets_& of) {
    const std::lock_guard lock(mutex_);
    return of.solver->clone();
  }
  template <typename Targets_>
  [[nodiscard]] PyPostures solve_many(Targets_& of, const py::object& target, py::ssize_t count,
                                      const OptionalArray& start) {
    const std::vector<JointVector> starts = starts_of(start, count);
    const auto targets = of.read(target, count, starts);
    std::vector<AnyPosture> found(targets.size());
    {
      const py::gil_scoped_release others_may_run;
      const std::size_t most = std::max(std::thread::hardware_concurrency(), 1U);
      const std::size_t share = (targets.size() + most - 1) / most;
      std::vector<std::thread> threads;
      for (std::size_t first = 0; first < targets.size(); first += share) {
        threads.emplace_back([&, first, last = std::min(first + share, targets.size())] {
          const auto own = clone(of);
          for (std::size_t i = first; i < last; ++i) found[i] = own->solve(targets[i], starts[i]);
        });
      }
      for (std::thread& thread : threads) thread.join();
    }
    PyPostures all{Array({count, py::ssize_t{dof()}}), py::array_t<bool>(count), Array(count), py::array_t<int>(count)};
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto at = static_cast<py::ssize_t>(i);
      std::copy_n(found[i].q.data(), dof(), all.q.mutable_data(at, 0));
      all.solved.mutable_at(at) = found[i].solved();
      all.error.mutable_at(at) = found[i].error;
      all.starts.mutable_at(at) = found[i].starts;
      all.status.push_back(found[i].status);
    }
    return all;
  }

  PyInverseOptions options_;
  JointLimits<kDynamic> limits_;
  AnyTargets any_;
  std::mutex mutex_;  ///< Locks the solver, because the interpreter's lock is released.
};

/// The solver of a model with these options, of the last call or new.
std::shared_ptr<PyInverse> solver_of(const Model& model, const PyInverseOptions& options) {
  auto last = std::static_pointer_cast<PyInverse>(model.inverse);
  if (last && last->options().is_same(options)) return last;
  auto solver = std::make_shared<PyInverse>(model, options);
  model.inverse = solver;
  return solver;
}

void bind_postures(py::module_& m) {
  py::class_<PyPosture>(m, "Posture", "A posture for a target: the result of inverse kinematics.")
      .def_property_readonly(
          "q", [](const PyPosture& self) { return array_of(self.q); },
          "The posture, or the nearest posture found [rad], or [m] for a prismatic joint, shape (n,).")
      .def_property_readonly("solved", &PyPosture::solved,
                             "Whether the target is reached within the tolerance, the ranges and the bounds.")
      .def_readonly("error", &PyPosture::error, "Largest distance [m] or angle [rad] from the target.")
      .def_readonly("status", &PyPosture::status, "OK or NOT_FOUND.")
      .def_readonly("starts", &PyPosture::starts, "Number of start postures used.")
      .def_readonly("rank_value", &PyPosture::rank_value, "The value by which inverse_all ranks; otherwise None.")
      .def("__repr__", [](const PyPosture& self) {
        return py::str("<Posture {}, error {}, q = {}>")
            .format(self.solved() ? "solved" : "not found", self.error, array_of(self.q));
      });
  py::class_<PyPostures>(m, "Postures", "Postures for K targets.")
      .def_readonly("q", &PyPostures::q, "The postures, shape (K, n) [rad or m].")
      .def_readonly("solved", &PyPostures::solved, "Whether each target is reached, shape (K,).")
      .def_readonly("error", &PyPostures::error, "Largest distance [m] or angle [rad] from each target, shape (K,).")
      .def_readonly("status", &PyPostures::status, "OK or NOT_FOUND, for each target.")
      .def_readonly("starts", &PyPostures::starts, "Number of start postures used for each target, shape (K,).");
}

}  // namespace

void bind_inverse(py::module_& m) {
  bind_postures(m);
  const auto none = py::none();
  const auto task = py::arg("task") = "pose";
  const auto stack = py::arg("stack") = none;
  const auto limits = py::arg("limits") = none;
  const auto bounds = py::arg("bounds") = py::tuple();
  const auto tolerance = py::arg("tolerance") = InverseOptions<>().tolerance;
  const auto starts = py::arg("starts") = InverseOptions<>().starts;
  const auto seed = py::arg("seed") = InverseOptions<>().seed;
  const auto rank = py::arg("rank") = "distance";

  py::class_<PyInverse, std::shared_ptr<PyInverse>>(
      m, "InverseKinematics", R"(Postures for targets, within the ranges of the joints: inverse kinematics.

From the given start, and then from start postures that fill the ranges evenly, a search makes damped Newton steps until
the target is reached. The result depends on the arguments only.

Parameters
----------
arm : Arm or Robot
    A Robot needs a stack.
task : str
    Task of the tip: 'position' or 'pose'.
stack : Stack, optional
    Several tasks in strict priority, which replace task. The tasks of the first level, and all tasks except postures,
    must reach their targets; a PostureTask below the first level is approached as far as the other tasks allow.
limits : JointLimits, optional
    Changes of the limits of the arm, or all limits. Only the ranges are used.
bounds : sequence of Clearance and TaskBounds
    Bounds that the postures keep: obstacles, self-collision, walls, cones.
tolerance : float
    Largest distance [m] and angle [rad] from a target.
starts : int
    Largest number of start postures, the given start included.
seed : int
    Selects the start postures after the given start.

Raises
------
ParameterError
    If an argument is out of range, or a task or a bound does not suit the arm.)")
      .def(py::init([](const Given<Model>& arm, const std::string& task_, const py::object& stack_,
                       const py::object& limits_, const py::object& bounds_, double tolerance_, int starts_,
                       std::uint32_t seed_) {
             const PyInverseOptions options{task_, stack_, limits_, tuple_of(bounds_), {tolerance_, starts_, seed_}};
             return std::make_shared<PyInverse>(arm.as("arm", "an arm or a Robot"), options);
           }),
           py::arg("arm"), py::kw_only(), task, stack, limits, bounds, tolerance, starts, seed)
      .def("solve", &PyInverse::solve, py::arg("target"), py::arg("start") = none,
           R"(A posture for a target: a Posture, or Postures for several targets.

target: shape (4, 4) for a pose, (3,) for a position, (x, y, angle) or (2,) for a planar arm [m, rad]; for a stack, a
dictionary by task name. With a leading axis of K entries, K targets, which are computed on all cores. start: the first
posture from which the search starts, shape (n,) or (K, n), moved into the ranges; by default, the middle of the ranges.
A target that is not reached raises nothing: see Posture.solved.)")
      .def("solve_all", &PyInverse::solve_all, py::arg("target"), py::arg("start") = none, py::arg("count") = 16,
           py::kw_only(), rank,
           R"(Up to `count` distinct postures for a target, from all start postures, sorted by rank.

rank: 'distance', the nearest to the start first; 'manipulability', the largest sqrt(det(J J')) of the task or of the
first level of the stack; 'ranges', the largest distance from the ends of the ranges, as a fraction of the range;
'clearance', the largest distance of the nearest checked pair, which needs a Clearance in bounds.)");

  auto model = py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"));
  model.def(
      "inverse",
      [](const Model& self, const py::object& target, const OptionalArray& start, const std::string& task_,
         const py::object& stack_, const py::object& limits_, const py::object& bounds_, double tolerance_, int starts_,
         std::uint32_t seed_) {
        return solver_of(self, {task_, stack_, limits_, tuple_of(bounds_), {tolerance_, starts_, seed_}})
            ->solve(target, start);
      },
      py::arg("target"), py::arg("start") = none, py::kw_only(), task, stack, limits, bounds, tolerance, starts, seed,
      "A posture for a target: InverseKinematics(arm, ...).solve(target, start).");
  model.def(
      "inverse_all",
      [](const Model& self, const py::object& target, const OptionalArray& start, int count, const std::string& rank_,
         const std::string& task_, const py::object& stack_, const py::object& limits_, const py::object& bounds_,
         double tolerance_, int starts_, std::uint32_t seed_) {
        return solver_of(self, {task_, stack_, limits_, tuple_of(bounds_), {tolerance_, starts_, seed_}})
            ->solve_all(target, start, count, rank_);
      },
      py::arg("target"), py::arg("start") = none, py::arg("count") = 16, py::kw_only(), rank, task, stack, limits,
      bounds, tolerance, py::arg("starts") = 256, seed,
      "Distinct postures for a target, sorted by rank: InverseKinematics(arm, ...).solve_all(target, start, "
      "count, rank=rank).");
}

}  // namespace fpbm::bindings
