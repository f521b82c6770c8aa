#include <optional>
#include <string>

#include "arrays.hpp"
#include "bindings.hpp"
#include "py_arm.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {
namespace {

using Array = py::array_t<double>;

/// What one tick did, as Python has it.
struct PyTick {
  Eigen::VectorXd q;
  Eigen::VectorXd qd;
  Eigen::VectorXd qdd;
  Status status;
  double scale;
  py::array_t<bool> saturated;
  double sigma;
  Eigen::VectorXd error;
};

template <typename Space>
PyTick python_tick(const Tick<Space, kDynamic>& tick) {
  py::array_t<bool> saturated(tick.q.size());
  for (Eigen::Index i = 0; i < tick.q.size(); ++i) saturated.mutable_at(i) = ((tick.saturated >> i) & 1U) != 0;
  return {tick.q, tick.qd, tick.qdd, tick.status, tick.scale, saturated, tick.sigma, tick.error};
}

struct PyCourse {
  AnyLoop::Courses course;
};

/// A tracker with any task.
class PyTracker {
  template <typename Space>
  static Space space_of(const LoopModel<Space>&);
  template <typename Model>
  using SpaceOf = decltype(space_of(std::declval<Model>()));

  template <typename Visitor>
  auto visit(Visitor&& visitor) const {
    return std::visit([&](const auto& model) { return visitor(*model); }, model_);
  }

 public:
  PyTracker(const PyArm& arm, const PyScheme& scheme, const ArrayLike& q0, const OptionalArray& qd0,
            const std::string& task, const std::optional<JointLimits<kDynamic>>& limits,
            const TrackerOptions<>& options)
      : dof_(arm.dof()) {
    State<kDynamic> start{joint_vector(q0, "q0", dof_), Joints::Zero(dof_)};
    if (qd0) start.qd = joint_vector(*qd0, "qd0", dof_);
    arm.visit(task, [&](const auto& model) {
      using Space = typename std::decay_t<decltype(model)>::Space;
      require_redundant(Space::kRows, dof_);
      const WholeArm<Space> whole{model.shared_from_this(), poses(arm), arm.limits()};
      model_ = make_loop(whole, scheme, start, options, limits ? *limits : arm.limits());
    });
  }

  [[nodiscard]] PyTick tick(const ArrayLike& x, const OptionalArray& xd, const OptionalArray& xdd) {
    return visit([&](auto& model) { return python_tick(model.tick(reference(model, x, xd, xdd))); });
  }

  [[nodiscard]] PyTick tick(PyCourse& course) {
    return visit([&](auto& model) {
      auto* same = std::get_if<AnyCourse<SpaceOf<decltype(model)>>>(&course.course);
      if (same == nullptr) throw std::invalid_argument("course: it was laid out for another task");
      return python_tick(model.tick(*same));
    });
  }

  [[nodiscard]] PyTick resolve_measured(const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                                        const OptionalArray& xd, const OptionalArray& xdd) {
    return visit([&](auto& model) {
      const State<kDynamic> measured{joint_vector(q, "q", dof_), joint_vector(qd, "qd", dof_)};
      return python_tick(model.resolve_measured(measured, reference(model, x, xd, xdd)));
    });
  }

  [[nodiscard]] PyCourse course(const PyPath& path, double ramp) const {
    return visit([&](auto& model) -> PyCourse {
      using Space = SpaceOf<decltype(model)>;
      return {AnyCourse<Space>(path.as<Space>(), model.tip(), ramp)};
    });
  }

  void stop() {
    visit([](auto& model) { model.stop(); });
  }
  void resume() {
    visit([](auto& model) { model.resume(); });
  }
  [[nodiscard]] Eigen::VectorXd q() const {
    return visit([](auto& model) -> Eigen::VectorXd { return model.state().q; });
  }
  [[nodiscard]] Eigen::VectorXd qd() const {
    return visit([](auto& model) -> Eigen::VectorXd { return model.state().qd; });
  }
  [[nodiscard]] Array tip() const {
    return visit([](auto& model) { return array_of(model.tip()); });
  }

 private:
  static std::shared_ptr<const TaskModel<Pose>> poses(const PyArm& arm) {
    return arm.visit("pose", [](const auto& model) -> std::shared_ptr<const TaskModel<Pose>> {
      if constexpr (std::is_same_v<typename std::decay_t<decltype(model)>::Space, Pose>) {
        return model.shared_from_this();
      } else {
        return nullptr;
      }
    });
  }

  template <typename Space>
  static Reference<Space> reference(const LoopModel<Space>&, const ArrayLike& x, const OptionalArray& xd,
                                    const OptionalArray& xdd) {
    auto result = Reference<Space>::hold(point<Space>(x, "x"));
    if (xd) result.xd = fixed_vector<Space::kRows>(*xd, "xd");
    if (xdd) result.xdd = fixed_vector<Space::kRows>(*xdd, "xdd");
    return result;
  }

  int dof_;
  AnyLoop::Models model_;
};

void bind_tick(py::module_& m) {
  py::class_<PyTick>(m, "Tick", "What one tick of a control loop did.")
      .def_readonly("q", &PyTick::q, "Command for the tick's end [rad], or [m] for a prismatic joint, shape (n,).")
      .def_readonly("qd", &PyTick::qd, "Its velocity [rad/s], shape (n,).")
      .def_readonly("qdd", &PyTick::qdd, "Mean acceleration over the tick [rad/s^2], shape (n,).")
      .def_readonly("status", &PyTick::status, "What became of it; where it failed, why the arm brakes.")
      .def_readonly("scale", &PyTick::scale, "How much of the task the limits left, from 0 to 1.")
      .def_readonly("saturated", &PyTick::saturated, "Which joints are on a bound, shape (n,).")
      .def_readonly("sigma", &PyTick::sigma,
                    "Lower bound on the least singular value of J at the tick's start, sqrt(m) times too low at most.")
      .def_readonly("error", &PyTick::error, "x - f(q) at the tick's start [m, rad], shape (m,).");
}

void bind_course(py::module_& m) {
  py::class_<PyCourse>(m, "PathFollower",
                       "A path laid out from a tip, with a clock that can pause and resume; made by Tracker.course.")
      .def(
          "pause", [](PyCourse& self) { std::visit([](auto& course) { course.pause(); }, self.course); },
          "Comes to rest on the path, within the course's ramp.")
      .def(
          "resume", [](PyCourse& self) { std::visit([](auto& course) { course.resume(); }, self.course); },
          "Goes on along the path.")
      .def_property_readonly(
          "time",
          [](const PyCourse& self) {
            return std::visit([](const auto& course) { return course.time(); }, self.course);
          },
          "Path time [s].")
      .def_property_readonly(
          "done",
          [](const PyCourse& self) {
            return std::visit([](const auto& course) { return course.done(); }, self.course);
          },
          "Whether path time has come to the path's end.");
}

}  // namespace

void bind_realtime(py::module_& m) {
  bind_tick(m);
  bind_course(m);
  const auto none = py::none();
  py::class_<PyTracker>(
      m, "Tracker",
      R"(Moves an arm tick by tick under a scheme, within its joints' limits, through singular postures, to rest.

tick integrates the tracker's own state by RK4: the command of an arm that is led by positions or velocities.
resolve_measured answers for a state measured just now, with the acceleration that a torque controller is to realise.
Never feed a measured state to tick. A scheme of velocity level is kept within the same limits.

Parameters
----------
arm, scheme
    What moves, and how.
q0 : array_like, shape (n,)
    Joint positions at the start [rad], within the limits.
qd0 : array_like, shape (n,), optional
    Joint velocities at the start [rad/s], zero unless given.
task : str
    'position' or 'pose'.
dt : float
    Length of a tick [s].
limits : JointLimits, optional
    The arm's own unless given. A joint with bounds needs one on its acceleration, except at velocity level.
pull : float
    How far away the target may seem at most [m, rad]: a farther one pulls no harder.
integral_gain, integral_bound : float
    Gain of the integral of the error, [1/s^3] or [1/s^2] at velocity level, off by default, and the most that it adds
    [m/s^2] or [m/s]. Stable below k1 k2.
singular_radius, singular_brake : float
    Damping near singular postures, where the scheme has none; 0 switches it off.

Raises
------
ValueError
    Where an argument is out of range, a limit is missing, or the start breaks one.)")
      .def(py::init([](const PyArm& arm, const PyScheme& scheme, const ArrayLike& q0, const OptionalArray& qd0,
                       const std::string& task, double dt, const std::optional<JointLimits<kDynamic>>& limits,
                       double pull, double gain, double bound, double radius, double brake) {
             const TrackerOptions<> options{dt, pull, gain, bound, SingularDamping<>(radius, brake)};
             return PyTracker(arm, scheme, q0, qd0, task, limits, options);
           }),
           py::arg("arm"), py::arg("scheme"), py::arg("q0"), py::kw_only(), py::arg("qd0") = none,
           py::arg("task") = "position", py::arg("dt") = 1e-3, py::arg("limits") = none, py::arg("pull") = 0.1,
           py::arg("integral_gain") = 0.0, py::arg("integral_bound") = 1.0,
           py::arg("singular_radius") = SingularDamping<>().radius(),
           py::arg("singular_brake") = SingularDamping<>().brake())
      .def("tick", py::overload_cast<PyCourse&>(&PyTracker::tick), py::arg("course"),
           "One tick along a course, whose clock goes on with it.")
      .def("tick", py::overload_cast<const ArrayLike&, const OptionalArray&, const OptionalArray&>(&PyTracker::tick),
           py::arg("x"), py::arg("xd") = none, py::arg("xdd") = none,
           R"(One tick toward a reference, at rest unless its velocity and acceleration are given.

x has shape (2,), (3,) or (4, 4) [m], xd and xdd (m,) [m/s, rad/s], linear rows first, in the base frame. Never fails:
where no motion can be found the arm brakes, and the tick's status says why.)")
      .def("resolve_measured", &PyTracker::resolve_measured, py::arg("q"), py::arg("qd"), py::arg("x"),
           py::arg("xd") = none, py::arg("xdd") = none,
           "The tick for a state measured now: its qdd [rad/s^2] is what a torque controller is to realise.")
      .def("course", &PyTracker::course, py::arg("path"), py::kw_only(), py::arg("ramp") = 0.5,
           "A path laid out from where the tip is now; ramp is how long a pause or a resumption takes [s].")
      .def("stop", &PyTracker::stop, "Brings every joint to rest as fast as the limits allow, until resume.")
      .def("resume", &PyTracker::resume, "Follows references again.")
      .def_property_readonly("q", &PyTracker::q, "Joint positions of its own state [rad].")
      .def_property_readonly("qd", &PyTracker::qd, "Joint velocities of its own state [rad/s].")
      .def_property_readonly("tip", &PyTracker::tip, "Where the tip of its own state is, in the base frame [m].");
}

}  // namespace fpbm::bindings
