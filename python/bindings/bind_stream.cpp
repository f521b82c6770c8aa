#include "fpbm/target/stream.hpp"

#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "model.hpp"
#include "stream.hpp"

namespace fpbm::bindings {
namespace {

using Number = std::optional<double>;

/// Number of points of the largest chunk.
constexpr int kPoints = 512;

/// fpbm::Stream<Space>, with the rows in use. Unused joints of a JointSpace<kMaxDof> rest at 0.
template <typename Space>
class StreamOf : public PyStream {
 public:
  using Any = Stream<Space, double, kPoints>;
  using Point = typename Any::Point;
  using Twist = typename Any::Twist;
  static constexpr bool kJoints = kIsJointSpace<Space>;

  StreamOf(int rows, std::vector<std::string> names, const Point& x0,
           const typename AxesOf<Space, double>::Bounds& bounds, const StreamOptions<>& options)
      : PyStream(kJoints ? TaskKind::kPosture : TaskKind::kPose, rows, options.dt),
        any_(x0, bounds, options),  // Constructed here: a stream of 64 joints has 4 MB.
        names_(std::move(names)) {}

  [[nodiscard]] StackTarget ahead(double seconds) const noexcept override {
    const Reference<Space> reference = any_.ahead(seconds);
    StackTarget target{{}, {}, reference.xd.head(size), reference.xdd.head(size)};
    if constexpr (kJoints) {
      target.q = reference.x.head(size);
    } else {
      target.at = reference.x;
    }
    return target;
  }
  void advance() noexcept override { any_.advance(); }
  bool set_speed(double fraction) noexcept override { return any_.set_speed(fraction); }

  [[nodiscard]] bool push(const ArrayLike& given, Number stamp) {
    const Point x = point_of(given, kJoints ? "q" : "x");
    return stamp ? any_.push(x, *stamp) : any_.push(x);
  }

  [[nodiscard]] bool push_chunk(const ArrayLike& points, Number period, const OptionalArray& times, Number stamp,
                                double first, const OptionalArray& velocities, const OptionalArray& accelerations) {
    const auto given = real_array(points, kJoints ? "postures" : "poses", kJoints ? 2 : 3);
    const py::ssize_t count = given.shape(0);
    const py::ssize_t each = kJoints ? size : 16;
    const bool fits = kJoints ? given.shape(1) == size : given.shape(1) == 4 && given.shape(2) == 4;
    if (count < 1 || count > kPoints || !fits) {
      validation::reject(kJoints ? "postures" : "poses",
                         ": must have shape " +
                             std::string(kJoints ? "(k, " + std::to_string(size) + ")" : "(k, 4, 4)") +
                             " with k from 1 to " + std::to_string(kPoints) + ", got " + shape_text(given));
    }
    if (period.has_value() == times.has_value()) validation::reject("period", " or times must be given, and not both");
    if (period) validation::require_positive("period", *period);
    validation::require_finite("first", first);
    std::optional<py::array_t<double>> at;
    if (times) at = rows("times", *times, count, 0);
    const auto rates = [&](const char* name, const OptionalArray& argument) {
      return argument ? std::optional(rows(name, *argument, count, size)) : std::nullopt;
    };
    const auto xd = rates("velocities", velocities);
    const auto xdd = rates("accelerations", accelerations);
    chunk_.clear();
    for (py::ssize_t k = 0; k < count; ++k) {
      TimedPoint<Space> point{};
      point.time = first + (at ? at->data()[k] : static_cast<double>(k) * *period);
      if (k > 0 && !(point.time > chunk_.back().time)) {
        validation::fail(validation::element("times", k), point.time - first, "greater than times[", k - 1, "]");
      }
      point.x =
          point_of(given.data() + k * each, [&] { return validation::element(kJoints ? "postures" : "poses", k); });
      const auto twist = [&](const py::array_t<double>& from) {
        Twist all = Twist::Zero();
        all.head(size) = Eigen::Map<const Eigen::VectorXd>(from.data() + k * size, size);
        return all;
      };
      if (xd) point.xd = twist(*xd);
      if (xdd) point.xdd = twist(*xdd);
      chunk_.push_back(point);
    }
    const auto n = static_cast<int>(count);
    return stamp ? any_.push_chunk(chunk_.data(), n, *stamp) : any_.push_chunk(chunk_.data(), n);
  }

  void reset(const ArrayLike& x) {
    const Point point = point_of(x, kJoints ? "q" : "x");
    if (!any_.reset(point)) validation::reject(kJoints ? "q" : "x", ": must be finite");
  }

  [[nodiscard]] Array x() const {
    if constexpr (kJoints) {
      return array_of(any_.reference().x.head(size));
    } else {
      return array_of(any_.reference().x);
    }
  }
  [[nodiscard]] const Any& any() const noexcept { return any_; }

 private:
  [[nodiscard]] static py::array_t<double> rows(const char* name, const ArrayLike& given, py::ssize_t count,
                                                py::ssize_t columns) {
    auto array = real_array(given, name, columns == 0 ? 1 : 2);
    if (array.shape(0) != count || (columns > 0 && array.shape(1) != columns)) {
      const std::string shape =
          "(" + std::to_string(count) + (columns == 0 ? ",)" : ", " + std::to_string(columns) + ")");
      validation::reject(name, ": must have shape " + shape + ", got " + shape_text(array));
    }
    return array;
  }

  /// A point from its numbers. A posture that is far outside the ranges of the joints is an error; the stream rejects
  /// numbers that are not finite.
  template <typename Name>
  [[nodiscard]] Point point_of(const double* numbers, const Name& name) const {
    if constexpr (kJoints) {
      Point q = Point::Zero();
      q.head(size) = Eigen::Map<const Eigen::VectorXd>(numbers, size);
      if (q.allFinite() && !any_.is_usable(q)) {
        Point alone = any_.reference().x;
        for (int i = 0; i < size; ++i) {
          alone(i) = q(i);
          if (any_.is_usable(alone)) continue;
          const auto [low, high] = any_.range(i);
          validation::fail(validation::element(name(), i), q(i), "within the range of ",
                           names_[static_cast<std::size_t>(i)], ", ", low, " to ", high,
                           ": are the units radians and metres, and the order of the joints correct?");
        }
      }
      return q;
    } else {
      const Eigen::Map<const RowMajor> H(numbers, 4, 4);
      return {H.topRightCorner<3, 1>(), H.topLeftCorner<3, 3>()};
    }
  }
  [[nodiscard]] Point point_of(const ArrayLike& given, const char* name) const {
    const auto array = real_array(given, name, kJoints ? 1 : 2);
    if (array.size() != (kJoints ? size : 16)) {
      validation::reject(name, ": must have shape " +
                                   (kJoints ? "(" + std::to_string(size) + ",)" : std::string("(4, 4)")) + ", got " +
                                   shape_text(array));
    }
    return point_of(array.data(), [name] { return validation::Argument(name); });
  }
  Any any_;
  std::vector<std::string> names_;
  std::vector<TimedPoint<Space>> chunk_;
};

using PostureStream = StreamOf<JointSpace<kMaxDof>>;
using PoseStream = StreamOf<Pose>;

StreamOptions<> options_of(double dt, double timeout, double delay, double blend, Number start) {
  StreamOptions<> options;
  options.dt = dt;
  options.timeout = timeout;
  options.delay = delay;
  options.blend = blend;
  options.start = start;
  return options;
}

std::unique_ptr<PostureStream> joint_stream(const Model& arm, const ArrayLike& q0, const py::object& limits, double dt,
                                            double timeout, double delay, double blend, Number start) {
  const JointLimits<kDynamic> own = limits_of(arm, limits).complete();
  const int n = arm.dof();
  const Vector<kDynamic> q = joint_vector(q0, "q0", n);
  auto all = JointLimits<kMaxDof>::none(kMaxDof);
  all.velocity.setOnes();
  all.acceleration.setOnes();
  validation::require_size("limits.lower", own.lower.size(), n);
  for (int i = 0; i < n; ++i) all.set(i, own.joint(i));
  for (int i = 0; i < n; ++i) {
    if (own.lower(i) <= q(i) && q(i) <= own.upper(i)) continue;
    validation::fail(validation::element("q0", i), q(i), "from ", own.lower(i), " to ", own.upper(i));
  }
  Vector<kMaxDof> x0 = Vector<kMaxDof>::Zero();
  x0.head(n) = q;
  return std::make_unique<PostureStream>(n, arm.joint_names, x0, all, options_of(dt, timeout, delay, blend, start));
}

std::unique_ptr<PoseStream> pose_stream(const ArrayLike& x0, double velocity, double acceleration, double jerk,
                                        double angular_velocity, double angular_acceleration, double angular_jerk,
                                        double dt, double timeout, double delay, double blend, Number start) {
  const TargetBounds<> bounds{velocity, acceleration, jerk, angular_velocity, angular_acceleration, angular_jerk};
  return std::make_unique<PoseStream>(6, std::vector<std::string>{}, transform(x0, "x0"), bounds,
                                      options_of(dt, timeout, delay, blend, start));
}

template <typename Bound, typename Class>
void bind_stream_of(Class& bound, const char* points) {
  const auto none = py::none();
  bound
      .def("push", &Bound::push, py::arg(Bound::kJoints ? "q" : "x"), py::arg("stamp") = none,
           R"(Adds a point that was observed at a time `stamp` [s] on any clock; default: now.

The reference passes the point `delay` later, and continues after the newest point at constant velocity until the
timeout. Returns False for a rejected point, which has no effect: a number is not finite, or the stamp is not newer than
all previous stamps or is from the future. Raises ParameterError for a wrong shape, and for a posture that is outside the
range of a joint by more than a tenth of its width; within this tenth, the joint moves to the end of its range.)")
      .def("push_chunk", &Bound::push_chunk, py::arg(points), py::kw_only(), py::arg("period") = none,
           py::arg("times") = none, py::arg("stamp") = none, py::arg("first") = 0.0, py::arg("velocities") = none,
           py::arg("accelerations") = none,
           R"(Replaces all points from the first point of a chunk on.

Point k is for the time stamp + first + k period, or stamp + first + times[k] [s]. Points whose time has passed have no
effect, so a late chunk is joined where it should be now. velocities and accelerations, one row for each point, are
estimated from the points if they are not given. After the last point, the reference rests at this point. Returns False
for a rejected chunk, as push. Raises ParameterError for wrong shapes and times.)")
      .def_property_readonly(Bound::kJoints ? "q" : "x", &Bound::x, "Reference at the start of the next tick.")
      .def_property_readonly(
          Bound::kJoints ? "qd" : "xd",
          [](const Bound& self) { return array_of(self.any().reference().xd.head(self.size)); },
          "Velocity of the reference.")
      .def_property_readonly(
          Bound::kJoints ? "qdd" : "xdd",
          [](const Bound& self) { return array_of(self.any().reference().xdd.head(self.size)); },
          "Acceleration of the reference.")
      .def_property_readonly(
          "age", [](const Bound& self) { return self.any().age(); }, "Time since the newest stamp [s].")
      .def_property_readonly(
          "gap", [](const Bound& self) { return array_of(self.any().gap().head(self.size)); },
          "Displacement from the reference to the target [rad, m].")
      .def(
          "advance", [](Bound& self) { self.advance(); }, "Advances by one tick; Tracker.tick calls advance.")
      .def(
          "set_speed",
          [](Bound& self, double fraction) {
            if (!self.set_speed(fraction)) validation::fail("fraction", fraction, "in (0, 1]");
          },
          py::arg("fraction"),
          "Reduces the bounds on velocity to a fraction in (0, 1] of the given bounds, until the next call.")
      .def_property_readonly(
          "speed", [](const Bound& self) { return self.any().speed(); },
          "Fraction of the bounds on velocity that set_speed has set.")
      .def("reset", &Bound::reset, py::arg(Bound::kJoints ? "q" : "x"),
           "Restarts at rest, with the same speed; chunks and an estimated clock are discarded.");
}

}  // namespace

void bind_stream(py::module_& m) {
  const auto none = py::none();
  const StreamOptions<> options;
  py::class_<PyStream>(m, "Stream", "A stream of points: JointStream or PoseStream.");
  auto joints = py::class_<PostureStream, PyStream>(
      m, "JointStream",
      R"(Computes a smooth reference of postures from chunks of a policy, trajectories or single postures.

Chunks may be late, early, overlapping, duplicate, out of order, or missing. The reference keeps the range and the bounds
on velocity, acceleration and jerk of each joint, joins a chunk in minimum time without overshoot, and rests at the last
point of the last chunk.

Parameters
----------
arm : SerialArm or Robot
    The arm, whose limits apply.
q0 : array_like, shape (n,)
    Start of the reference, at rest [rad, m].
limits : JointLimits, optional
    Other limits. For a Tracker, use accelerations and jerks that are 5 % below the limits of the tracker.
dt : float
    Length of a tick [s].
timeout : float
    Time without a message after which the reference of single postures stops [s].
delay : float
    Time after which the reference passes the postures of push [s]: the period of the stream plus its jitter. With 0, the
    reference follows a prediction from the last three postures.
blend : float
    Least time in which the target changes from a chunk to the next [s]: gentle corrections for noisy policies. With 0, a chunk
    that does not continue the chunk before is joined in minimum time.
start : float, optional
    Time of the first tick on the clock of the stamps [s]. Default: estimated from the stamps.

Raises
------
ParameterError
    If an argument is out of range.)");
  joints.def(py::init(&joint_stream), py::arg("arm"), py::arg("q0"), py::kw_only(), py::arg("limits") = none,
             py::arg("dt") = options.dt, py::arg("timeout") = options.timeout, py::arg("delay") = options.delay,
             py::arg("blend") = options.blend, py::arg("start") = none);
  bind_stream_of<PostureStream>(joints, "postures");
  auto poses = py::class_<PoseStream, PyStream>(
      m, "PoseStream",
      R"(Computes a smooth reference of a pose from chunks of poses or single poses, as JointStream does.

Parameters
----------
x0 : array_like, shape (4, 4)
    Start of the reference, at rest, in the base frame [m].
velocity, acceleration, jerk : float
    Bounds of each axis of the base frame, [m/s], [m/s^2] and [m/s^3].
angular_velocity, angular_acceleration, angular_jerk : float
    Bounds of the angle about each axis [rad/s], [rad/s^2] and [rad/s^3].
dt, timeout, delay, blend, start
    As for JointStream.

Raises
------
ParameterError
    If an argument is out of range.)");
  poses.def(py::init(&pose_stream), py::arg("x0"), py::kw_only(), py::arg("velocity"), py::arg("acceleration"),
            py::arg("jerk"), py::arg("angular_velocity"), py::arg("angular_acceleration"), py::arg("angular_jerk"),
            py::arg("dt") = options.dt, py::arg("timeout") = options.timeout, py::arg("delay") = options.delay,
            py::arg("blend") = options.blend, py::arg("start") = none);
  bind_stream_of<PoseStream>(poses, "poses");
}

}  // namespace fpbm::bindings
