#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "motion.hpp"
#include "read.hpp"
#include "scheme.hpp"
#include "sources.hpp"
#include "stack_loop.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {
namespace {

/// The start of a tick: the state, the nearest pair, and the dynamics, null if torques are not known.
struct TickStart {
  State<kDynamic> state;
  std::optional<PyNearest> nearest;
  std::shared_ptr<const AnyDynamics> dynamics;
};

/// Result of one tick. The arrays of Python are made when a program reads the attributes.
struct PyTick {
  JointVector q;
  JointVector qd;
  JointVector qdd;
  Status status;
  double scale;
  JointBits saturated;
  Eigen::VectorXd error;
  TickStart start;
  Eigen::VectorXd scales;                         ///< For a stack: scale of each level.
  std::shared_ptr<const StackLoop::Parts> parts;  ///< For a stack: the tasks of the error's entries.

  [[nodiscard]] py::array_t<bool> saturated_joints() const { return array_of(saturated, q.size()); }
  [[nodiscard]] std::optional<Array> torque() const {
    const auto& [state, nearest, dynamics] = start;
    return dynamics ? std::optional(array_of(torque_of(*dynamics, state.q, state.qd, qdd))) : std::nullopt;
  }
  [[nodiscard]] std::optional<Array> level_scales() const {
    return parts ? std::optional(array_of(scales)) : std::nullopt;
  }
  [[nodiscard]] std::optional<PyPoints> task_errors() const {
    if (!parts) return std::nullopt;
    PyPoints errors;
    Eigen::Index row = 0;
    for (const auto& [name, size] : *parts) {
      errors[py::str(name)] = array_of(error.segment(row, size));
      row += size;
    }
    return errors;
  }
};

template <typename Space>
PyTick python_tick(const Tick<Space, kDynamic>& tick, TickStart start) {
  return {tick.q, tick.qd, tick.qdd, tick.status, tick.scale, tick.saturated, tick.error, std::move(start), {}, {}};
}

/// For a stack.
PyTick python_tick(const StackLoop& loop, const StackLoop::Result& tick, TickStart start) {
  return {tick.q,         tick.qd,          tick.qdd,         tick.status,       tick.scale,
          tick.saturated, loop.error(tick), std::move(start), loop.scales(tick), loop.parts()};
}

/// A tracker of one task or of a stack of tasks.
class PyTracker {
  template <typename Space>
  using Held = std::unique_ptr<AnyTracker<Space>>;
  using Stacked = std::unique_ptr<StackLoop>;
  using Any = std::variant<Held<Position<2>>, Held<PlanarPose>, Held<Position<3>>, Held<Pose>, Stacked>;

  /// Calls visitor(tracker, Space) with the tracker of a single task. If the tracker has a stack, throws
  /// std::invalid_argument with the remedy.
  template <typename Visitor>
  auto visit(const char* remedy, Visitor&& visitor) const {
    return std::visit(
        [&](const auto& held) -> decltype(visitor(*std::get<0>(any_), Position<2>{})) {
          if constexpr (std::is_same_v<std::decay_t<decltype(held)>, Stacked>) {
            validation::reject("tracker", std::string(" has a stack of tasks: ") + remedy);
          } else {
            return visitor(*held, typename std::decay_t<decltype(*held)>::Space{});
          }
        },
        any_);
  }

 public:
  PyTracker(const Model& model, const Scheme& given_scheme, const ArrayLike& q0, const OptionalArray& qd0,
            const OptionalArray& qdd0, const std::string& task, const py::object& stack, const py::object& limits,
            const TrackerOptions<>& options, const py::object& given)
      : dof_(model.dof()),
        dt_(options.dt),
        scheme_(given_scheme.on(model).with_null_damping(options.null_damping)),
        limits_(limits_of(model, limits)) {
    const Scheme scheme = given_scheme.on(model);
    State<kDynamic> start{joint_vector(q0, "q0", dof_), JointVector::Zero(dof_)};
    if (qd0) start.qd = joint_vector(*qd0, "qd0", dof_);
    const JointVector before = qdd0 ? joint_vector(*qdd0, "qdd0", dof_) : JointVector::Zero(dof_);
    const AnyBounds further = bounds_of(model, given);
    const TrackerStart from{start, options, limits_, before, further};
    if (scheme_.level == Level::kAcceleration) dynamics_ = model.dynamics_if_known();
    if (!stack.is_none()) {
      any_ = std::make_unique<StackLoop>(read_stack(stack, model), scheme, from);
      return;
    }
    const auto* arm = dynamic_cast<const Arm*>(&model);
    if (arm == nullptr) validation::reject("stack", ": must be given for a Robot, because a Robot has several tips");
    any_ = arm->visit(task, [&](const auto& any, auto space) {
      using Space = decltype(space);
      require_enough_joints<Space>(dof_);
      return Any(make_tracker<Space>(any, scheme, from));
    });
  }

  /// Calls visitor(tracker), also with a tracker of a stack.
  template <typename Visitor>
  auto visit_any(Visitor&& visitor) const {
    return std::visit(
        [&](const auto& held) {
          if constexpr (std::is_same_v<std::decay_t<decltype(held)>, Stacked>) {
            return visitor(held->tracker());
          } else {
            return visitor(*held);
          }
        },
        any_);
  }

  [[nodiscard]] PyTick tick(const PyReferences& references) {
    StackLoop& loop = stack();
    TickStart start = start_of(loop.tracker(), loop.tracker().state());
    return python_tick(loop, loop.tick(references), std::move(start));
  }

  [[nodiscard]] PyTick resolve_measured(const ArrayLike& q, const ArrayLike& qd, const PyReferences& references) {
    StackLoop& loop = stack();
    const State<kDynamic> measured{joint_vector(q, "q", dof_), joint_vector(qd, "qd", dof_)};
    TickStart start = start_of(loop.tracker(), measured);
    return python_tick(loop, loop.resolve_measured(measured, references), std::move(start));
  }

  void enable(int level, bool on) { stack().enable(level, on); }
  void reorder(const std::vector<int>& order) { stack().reorder(order); }
  [[nodiscard]] Array frame(const std::string& task) { return stack().frame(task); }

  [[nodiscard]] PyTick tick(const ArrayLike& x, const OptionalArray& xd, const OptionalArray& xdd) {
    return visit(kByName, [&](auto& tracker, auto space) {
      const auto target = reference<decltype(space)>(x, xd, xdd);
      TickStart start = start_of(tracker, tracker.state());
      return python_tick(tracker.tick(target), std::move(start));
    });
  }

  [[nodiscard]] PyTick tick(PyFollower& follower) {
    if (std::holds_alternative<Stacked>(any_)) {
      PyReferences references;
      for (const auto& [name, each] : follower.each) references[py::str(name)] = py::cast(&follower);
      return tick(references);
    }
    return visit(kByName, [&](auto& tracker, auto space) {
      auto* same = std::get_if<AnyFollower<decltype(space)>>(&follower.of(""));
      if (same == nullptr) validation::reject("follower", ": is for another task: call this tracker's follow()");
      TickStart start = start_of(tracker, tracker.state());
      return python_tick(tracker.tick(*same), std::move(start));
    });
  }

  [[nodiscard]] PyTick tick(PyTargetFilter& filter) {
    return visit(kByName, [&](auto& tracker, auto space) {
      auto* same = std::get_if<TargetFilter<decltype(space)>>(&filter.any);
      if (same == nullptr) {
        validation::reject("filter", ": is for another task: must be a TargetFilter with the tracker's task");
      }
      if (same->dt() != dt_) validation::fail("filter's dt", same->dt(), "the tracker's dt = ", dt_);
      TickStart start = start_of(tracker, tracker.state());
      return python_tick(tracker.tick(*same), std::move(start));
    });
  }

  [[nodiscard]] PyTick tick(PyStream& stream) {
    const auto* stacked = std::get_if<Stacked>(&any_);
    if (stacked == nullptr || (*stacked)->plan().tasks.size() != 1) {
      validation::reject("stream", ": must be given in a dictionary by task name, to a tracker of a stack");
    }
    PyReferences references;
    references[py::str((*stacked)->plan().tasks.front().name)] = py::cast(&stream);
    return tick(references);
  }

  [[nodiscard]] PyTick resolve_measured(const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                                        const OptionalArray& xd, const OptionalArray& xdd) {
    return visit(kByName, [&](auto& tracker, auto space) {
      const State<kDynamic> measured{joint_vector(q, "q", dof_), joint_vector(qd, "qd", dof_)};
      const auto target = reference<decltype(space)>(x, xd, xdd);
      TickStart start = start_of(tracker, measured);
      return python_tick(tracker.resolve_measured(measured, target), std::move(start));
    });
  }

  [[nodiscard]] PyFollower follow(const Given<Path>& given, double ramp, const std::optional<std::string>& task,
                                  bool keep_path, double reserve) {
    (void)given.as("path", "a path");
    const auto [object, speed, shortest] = kept_of(given, keep_path);
    const Path& path = py::cast<const Path&>(object);
    const FollowOptions options = follow_options(ramp, keep_path, reserve, speed, shortest);
    if (const auto* stacked = std::get_if<Stacked>(&any_)) {
      return (*stacked)->follow({{(*stacked)->plan().follower(task).name, &path}}, options);
    }
    if (task) validation::reject("task", " = '" + *task + "': must not be given for a tracker with one task");
    return visit("", [&](auto& tracker, auto space) -> PyFollower {
      using Space = decltype(space);
      AnyPath<Space> any = path.as<Space>();
      if (keep_path) {
        const Motion<Space> motion{&tracker.arm(), any, scheme_, tracker.state(), TimeGrid<double>(dt_, dt_), nullptr};
        any = AnyPath<Space>(TimedPath(
            any, motion.kept_motion(limits_, tracker.bounds(), any.duration(), options.shortest, options.fastest)));
      }
      return {{{"", AnyFollower<Space>(any, tracker.tip(), ramp)}}};
    });
  }

  /// Paths of several tasks of a stack, with one clock.
  [[nodiscard]] PyFollower follow_all(const py::typing::Dict<py::str, py::object>& given, double ramp, bool keep_path,
                                      double reserve) {
    StackLoop& loop = stack();
    std::vector<py::object> objects;
    std::vector<std::pair<std::string, const Path*>> paths;
    if (given.empty()) validation::reject("path", " = {}: must have a path for at least one task");
    double tip_speed = 0.0;
    double shortest = 0.0;
    for (const auto& [name, each] : given) {
      if (!py::isinstance<Path>(each)) validation::reject("path", ": must be a dictionary of paths by task name");
      const auto [object, speed, duration] = kept_of(each, keep_path);
      if (paths.empty()) tip_speed = speed;
      if (!paths.empty() && std::isfinite(speed)) validation::reject("path", ": only the first path may have a speed");
      shortest = std::max(shortest, duration);
      objects.push_back(object);
      paths.emplace_back(py::cast<std::string>(name), &py::cast<const Path&>(object));
    }
    return loop.follow(paths, follow_options(ramp, keep_path, reserve, tip_speed, shortest));
  }

  void move(const std::string& name, const Given<Shape>& given, const ArrayLike& velocity) {
    const Shape& shape = given.as("shape", "a HalfSpace, a Cuboid or a Capsule");
    const Vector<3> v = fixed_vector<3>(velocity, "velocity");
    visit_any([&](auto& tracker) { move_obstacle(tracker.bounds().clearance(), name, shape, v); });
  }

  [[nodiscard]] py::object tip() {
    if (const auto* stacked = std::get_if<Stacked>(&any_)) return (*stacked)->points();
    return visit("", [](auto& tracker, auto) -> py::object { return array_of(tracker.tip()); });
  }

 private:
  static constexpr const char* kByName = "must be given a dictionary of references by task name";

  /// The path itself, or Path._kept() of Python: the geometry, the bound on the speed [m/s] and the least duration [s].
  static std::tuple<py::object, double, double> kept_of(const py::handle& path, bool keep) {
    if (keep) return py::cast<std::tuple<py::object, double, double>>(path.attr("_kept")());
    return {py::reinterpret_borrow<py::object>(path), 0.0, 0.0};
  }
  [[nodiscard]] FollowOptions follow_options(double ramp, bool keep_path, double reserve, double tip_speed,
                                             double shortest) const {
    const FastestOptions fastest{dt_, tip_speed, FastestOptions().tip_acceleration, reserve};
    return {ramp, keep_path, fastest, shortest, scheme_, limits_};
  }

  /// Throws std::invalid_argument if the tracker has one task.
  [[nodiscard]] StackLoop& stack() const {
    const auto* stacked = std::get_if<Stacked>(&any_);
    if (stacked == nullptr) validation::reject("tracker", " has one task: must have a stack of tasks");
    return **stacked;
  }

  /// The start of a tick in a state.
  template <typename Tracker>
  [[nodiscard]] TickStart start_of(Tracker& tracker, const State<kDynamic>& state) const {
    return {state, nearest_at(tracker.bounds().clearance(), state.q), dynamics_};
  }

  template <typename Space>
  static Reference<Space> reference(const ArrayLike& x, const OptionalArray& xd, const OptionalArray& xdd) {
    auto result = Reference<Space>::hold(point<Space>(x, "x"));
    if (xd) result.xd = fixed_vector<Space::kRows>(*xd, "xd");
    if (xdd) result.xdd = fixed_vector<Space::kRows>(*xdd, "xdd");
    return result;
  }

  int dof_;
  double dt_;
  Scheme scheme_;  ///< For plans, with the null-space damping of the tracker.
  JointLimits<kDynamic> limits_;
  std::shared_ptr<const AnyDynamics> dynamics_;  ///< For the torques of ticks; null if they are not known.
  Any any_;
};

void bind_tick(py::module_& m) {
  const auto array = [](auto values) { return [values](const PyTick& tick) { return array_of(tick.*values); }; };
  py::class_<PyTick>(m, "Tick", "Result of one tick of a control loop.")
      .def_property_readonly("q", array(&PyTick::q),
                             "Joint command for the end of the tick [rad], or [m] for a prismatic joint, shape (n,).")
      .def_property_readonly("qd", array(&PyTick::qd), "Velocity of the command [rad/s], shape (n,).")
      .def_property_readonly("qdd", array(&PyTick::qdd), "Mean acceleration over the tick [rad/s^2], shape (n,).")
      .def_property_readonly(
          "torque", &PyTick::torque,
          "Torques of inverse dynamics [Nm], or [N] for a prismatic joint, for qdd in the state at the tick's start, "
          "without\ndry friction, shape (n,): the feed-forward torques. None at velocity level, and if the arm has no "
          "dynamics.")
      .def_readonly("status", &PyTick::status, "Status of the tick; if the tick failed, the reason why the arm brakes.")
      .def_readonly("scale", &PyTick::scale, "Task scale that the limits admit, from 0 to 1.")
      .def_property_readonly("saturated", &PyTick::saturated_joints, "Which joints are on a bound, shape (n,).")
      .def_property_readonly("error", array(&PyTick::error), "x - f(q) at the tick's start [m, rad], shape (m,).")
      .def_property_readonly("scales", &PyTick::level_scales,
                             "For a stack: task scale of each level, from 0 to 1, shape (levels,); else None.")
      .def_property_readonly(
          "errors", &PyTick::task_errors,
          "For a stack: x - f(q) of each task by name, zero in rows that the task does not select; else None.")
      .def_property_readonly(
          "nearest", [](const PyTick& tick) { return tick.start.nearest; },
          "The nearest checked pair of shapes at the tick's start; None without a clearance.");
}

void bind_follower(py::module_& m) {
  const auto all = [](auto visitor) {
    return [visitor](PyFollower& self) {
      for (auto& [name, any] : self.each) std::visit(visitor, any);
    };
  };
  const auto of = [](auto visitor) {
    return [visitor](const PyFollower& self) { return std::visit(visitor, self.each.front().second); };
  };
  py::class_<PyFollower>(m, "PathFollower",
                         "A path from the tip, with a clock that can pause, resume and run slower; the result of "
                         "Tracker.follow.")
      .def("pause", all([](auto& follower) { follower.pause(); }), "Stops on the path within the ramp time.")
      .def("resume", all([](auto& follower) { follower.resume(); }), "Continues along the path.")
      .def(
          "set_speed",
          [](PyFollower& self, double fraction) {
            for (auto& [name, any] : self.each) {
              if (!std::visit([&](auto& follower) { return follower.set_speed(fraction); }, any)) {
                validation::fail("fraction", fraction, "in (0, 1]");
              }
            }
          },
          py::arg("fraction"),
          "Changes the speed to a fraction in (0, 1] of the path's speed, within the ramp time; during a pause, after "
          "resume().")
      .def_property_readonly("speed", of([](const auto& follower) { return follower.speed(); }),
                             "Fraction of the path's speed that set_speed has set.")
      .def_property_readonly("time", of([](const auto& follower) { return follower.time(); }), "Path time [s].")
      .def_property_readonly("done", of([](const auto& follower) { return follower.done(); }),
                             "Whether path time is at the path's end.");
}

}  // namespace

void bind_realtime(py::module_& m) {
  const auto any = [](auto visitor) { return [visitor](PyTracker& self) { return self.visit_any(visitor); }; };
  bind_tick(m);
  bind_follower(m);
  const auto none = py::none();
  py::class_<PyTracker>(
      m, "Tracker",
      R"(Moves an arm tick by tick under a scheme, within joint limits and through singular postures. If the target is
unreachable, the arm stops.

tick advances the tracker's own state; the result is the command for an arm with position or velocity control.
resolve_measured computes the acceleration for a torque controller from a measured state.
Never pass a measured state to tick. The limits hold at velocity level and at acceleration level.

Parameters
----------
arm, scheme
    The arm and its scheme.
q0 : array_like, shape (n,)
    Joint positions at the start [rad], within the limits.
qd0, qdd0 : array_like, shape (n,), optional
    Joint velocities at the start [rad/s], and accelerations just before the start [rad/s^2], for bounds on jerk;
    default: zero.
task : str
    Task of the tip: 'position' or 'pose'.
stack : Stack, optional
    Several tasks in strict priority, which replace task. The argument of tick is then a dictionary of references.
dt : float
    Length of a tick [s].
limits : JointLimits, optional
    Changes of the limits of the arm, or all limits. A bounded joint needs a bound on acceleration, except at velocity
    level.
error_bound : float
    Largest tip error that the feedback uses: of the position in arm lengths (from the first joint to the tip, along the
    links), of the orientation [rad]. The limits determine the largest error of the joints of a PostureTask.
integral_gain, integral_bound : float
    Gain of the integral of the error, [1/s^3] or [1/s^2] at velocity level; 0: no integral. Largest contribution of the
    integral [arm lengths and radians per s^2, or per s]. A gain below k1 k2 is stable.
stall_time : float
    If an arm is slowed, or farther than error_bound from its target, and makes no progress for this time [s], the arm
    stops until the target moves, or until resume(). math.inf: a lack of progress never stops the arm.
singular_radius, singular_brake : float
    Damping near singular postures, if the scheme has none; 0: no damping.
null_damping : float
    Null-space damping [1/s], if a scheme of acceleration level has none; without damping, the self-motion never stops.
    0: no damping.
recovery : bool
    Whether a stalled arm may move to a remembered posture from which the target is reachable.
keep_first_level : bool
    Whether the first level of a stack, for example a grasp of two arms, has priority over speed. The lower levels leave
    the first level a reserve of the limits: 0.7 of each bound on acceleration and 0.35 of each bound on velocity. stop
    keeps the first level: its references are held at rest, and the joints stop in its null space. A task that
    is farther than 0.001 characteristic lengths, or 0.001 rad, from its reference stays at its current point.
measured_delay : int
    Largest age of the states for resolve_measured [ticks]: the time from the measurement to the start of the tick in
    which the robot realises the result. 0: exact present states, as in a simulation.
bounds : sequence of Clearance and TaskBounds
    A Clearance: self-collision and obstacles that the arm avoids. While obstacles are at rest, no checked pair comes
    closer than the margin, for every reference. TaskBounds: walls for points of links, cones for axes, speeds. A tick is
    executed only if the arm can then stop within all bounds; otherwise the arm brakes immediately.
recover_start : bool
    Whether the start may be outside the joints' ranges, or too fast for their bounds. The joints then return within the
    bounds on velocity, acceleration and jerk, and the other joints follow the task.

Raises
------
ParameterError
    If an argument is out of range, a limit is missing, or the start violates a limit or a bound; with recover_start,
    the start may violate limits.)")
      .def(py::init([](const Given<Model>& arm, const Given<Scheme>& scheme, const ArrayLike& q0,
                       const OptionalArray& qd0, const OptionalArray& qdd0, const std::string& task,
                       const py::object& stack, double dt, const py::object& limits, double error_bound, double gain,
                       double bound, double stall_time, double radius, double brake, double null_damping, bool recovery,
                       bool keep_first_level, int measured_delay, const py::object& bounds, bool recover_start) {
             const SingularDamping<> singular(radius, brake);
             TrackerOptions<> options{dt, error_bound, gain, bound, stall_time, singular, null_damping};
             options.recovery = recovery;
             options.keep_first_level = keep_first_level;
             options.measured_delay = measured_delay;
             options.recover_start = recover_start;
             return PyTracker(arm.as("arm", "an arm or a Robot"), scheme.as("scheme", "a scheme"), q0, qd0, qdd0, task,
                              stack, limits, options, bounds);
           }),
           py::arg("arm"), py::arg("scheme"), py::arg("q0"), py::kw_only(), py::arg("qd0") = none,
           py::arg("qdd0") = none, py::arg("task") = "position", py::arg("stack") = none, py::arg("dt") = 1e-3,
           py::arg("limits") = none, py::arg("error_bound") = 0.1, py::arg("integral_gain") = 0.0,
           py::arg("integral_bound") = 1.0, py::arg("stall_time") = TrackerOptions<>().stall_time,
           py::arg("singular_radius") = SingularDamping<>().radius(),
           py::arg("singular_brake") = SingularDamping<>().brake(),
           py::arg("null_damping") = TrackerOptions<>().null_damping, py::arg("recovery") = TrackerOptions<>().recovery,
           py::arg("keep_first_level") = TrackerOptions<>().keep_first_level,
           py::arg("measured_delay") = TrackerOptions<>().measured_delay, py::arg("bounds") = py::tuple(),
           py::arg("recover_start") = TrackerOptions<>().recover_start)
      .def("tick", py::overload_cast<PyFollower&>(&PyTracker::tick), py::arg("follower"),
           "One tick along a path. The clock of the path advances by one tick.")
      .def("tick", py::overload_cast<PyTargetFilter&>(&PyTracker::tick), py::arg("filter"),
           "One tick toward the reference of a filter. The filter advances by one tick, also after stop.")
      .def("tick", py::overload_cast<PyStream&>(&PyTracker::tick), py::arg("stream"),
           "One tick of a stack of one task toward the reference of a stream. The stream advances by one tick.")
      .def("tick", py::overload_cast<const PyReferences&>(&PyTracker::tick), py::arg("references"),
           R"(One tick of a stack toward references: a dictionary by task name.

Each value is a point x, (x, xd) or (x, xd, xdd), for positions and poses also a PathFollower or a TargetFilter, and
for postures and poses also a JointStream or PoseStream. x
has shape (3,) for a position, (3, 3) for an orientation, (4, 4) for a pose, (3,) for an axis, (joints,) for a posture
[m, rad]. A task that is not in the dictionary keeps its last target, at rest; the first target is the start of the
task.)")
      .def("tick", py::overload_cast<const ArrayLike&, const OptionalArray&, const OptionalArray&>(&PyTracker::tick),
           py::arg("x"), py::arg("xd") = none, py::arg("xdd") = none,
           R"(One tick toward a reference, at rest unless its velocity and acceleration are given.

x has shape (2,), (3,) or (4, 4) [m], xd and xdd (m,) [m/s, rad/s], linear rows first, in the base frame. Never fails:
if there is no motion, the arm brakes, and the status of the tick is the cause.)")
      .def("resolve_measured",
           py::overload_cast<const ArrayLike&, const ArrayLike&, const PyReferences&>(&PyTracker::resolve_measured),
           py::arg("q"), py::arg("qd"), py::arg("references"),
           "The tick of a stack for a measured state; references as for tick.")
      .def("resolve_measured",
           py::overload_cast<const ArrayLike&, const ArrayLike&, const ArrayLike&, const OptionalArray&,
                             const OptionalArray&>(&PyTracker::resolve_measured),
           py::arg("q"), py::arg("qd"), py::arg("x"), py::arg("xd") = none, py::arg("xdd") = none,
           R"(The tick for a measured state: its qdd [rad/s^2] is the acceleration for a torque controller.

The state may be up to measured_delay ticks old.)")
      .def("follow", &PyTracker::follow_all, py::arg("paths"), py::kw_only(), py::arg("ramp") = 0.5,
           py::arg("keep_path") = false, py::arg("reserve") = 0.05,
           R"(Paths of several tasks of a stack, by task name, with one clock; options as for one path.)")
      .def("follow", &PyTracker::follow, py::arg("path"), py::kw_only(), py::arg("ramp") = 0.5, py::arg("task") = none,
           py::arg("keep_path") = false, py::arg("reserve") = 0.05,
           R"(A path from the present tip, for tick.

For a stack, a path from the task of that name; the name is optional if only one task is a position or a pose.

Parameters
----------
path : Path
    The path. With keep_path, the duration of the path is a lower bound on the duration of the motion.
ramp : float
    Duration of a pause or a resumption [s].
task : str, optional
    Task of a stack.
keep_path : bool
    Whether the tip stays on the path if the path is faster than the limits allow (docs: Paths in the least time). The
    clock of fastest(), slowed by the reserve, replaces the time law. Obstacles, other targets and disturbances, which
    the plan does not know, slow the clock further. The ramp is extended until no change of the speed exceeds a bound.
    With keep_first_level, stop stops the arm on the path. Needs an arm at rest; takes some 50 ms, at acceleration level
    some 150 ms.
reserve : float
    Fraction by which the motion lasts longer than the least time.

Raises ParameterError if the arm cannot follow the path within its limits and bounds.)")
      .def("enable", &PyTracker::enable, py::arg("level"), py::arg("on"),
           R"(Enables or disables a level of a stack below the first; levels are counted from 0.

Commands stay within all bounds.)")
      .def("reorder", &PyTracker::reorder, py::arg("order"),
           R"(Reorders the levels of a stack: the new level k is the old level order[k].

The tasks keep their targets; tick.scales and enable() use the new levels. Commands stay within all bounds.)")
      .def("frame", &PyTracker::frame, py::arg("task"),
           "For a stack: the frame of the task of that name, in the base frame, shape (4, 4); for an axis task, z is "
           "the axis.")
      .def("move", &PyTracker::move, py::arg("name"), py::arg("shape"), py::arg("velocity") = py::make_tuple(0, 0, 0),
           R"(Moves an obstacle of the clearance to its present place; velocity [m/s] is the expected velocity.

shape must have the kind of the given obstacle; place and size may change. Raises ParameterError if no obstacle has
that name, or if the shape has another kind.)")
      .def(
          "set_speed",
          [](PyTracker& self, double fraction) {
            if (!self.visit_any([&](auto& tracker) { return tracker.set_speed(fraction); })) {
              validation::fail("fraction", fraction, "in (0, 1]");
            }
          },
          py::arg("fraction"),
          "Sets the speed of the paths and filters of the following ticks to a fraction in (0, 1]: "
          "PathFollower.set_speed\n"
          "and TargetFilter.set_speed, for an operator's slider. Targets without a filter are not slowed.")
      .def("stop", any([](auto& tracker) { tracker.stop(); }),
           "Brings every joint to rest as fast as the limits allow, until resume; with keep_first_level, in the null\n"
           "space of the first level.")
      .def("resume", any([](auto& tracker) { tracker.resume(); }), "Follows references again.")
      .def_property_readonly("q", any([](auto& tracker) { return array_of(tracker.state().q); }),
                             "Joint positions of the tracker's own state [rad].")
      .def_property_readonly("qd", any([](auto& tracker) { return array_of(tracker.state().qd); }),
                             "Joint velocities of the tracker's own state [rad/s].")
      .def_property_readonly("qdd", any([](auto& tracker) { return array_of(tracker.acceleration()); }),
                             "Joint accelerations of the last tick [rad/s^2].")
      .def_property_readonly("sigma", any([](auto& tracker) { return tracker.sigma(); }),
                             "Lower bound on the least singular value of J of the tracker's own state, tight within a "
                             "factor sqrt(m); for a stack, of the first level.")
      .def_property_readonly(
          "tip", &PyTracker::tip,
          "Tip of the tracker's own state in the base frame [m]; for a stack, the point of each task by name.");
}

}  // namespace fpbm::bindings
