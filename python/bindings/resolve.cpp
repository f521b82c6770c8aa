#include "resolve.hpp"

namespace fpbm::bindings {
namespace {

[[noreturn]] void raise(Status status, const std::string& where = {}) {
  const py::object type = py::module_::import("fpbm_cpp.errors").attr("ResolutionError");
  const std::string text = where + message(status) + ". " + advice(status);
  py::set_error(type, type(py::cast(status), text));
  throw py::error_already_set();
}

void require_xdd(const Scheme& scheme, const OptionalArray& xdd) {
  if (scheme.level == Level::kAcceleration && !xdd) {
    validation::reject("xdd", ": must be given for an acceleration-level scheme");
  }
}

/// Joint motion of the scheme made(Space) in a state.
template <typename Space, typename Made>
Array resolve(const Scheme& scheme, const Kinematics<Space, kDynamic>& kinematics, const State<kDynamic>& state,
              const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd, const OptionalOut& out,
              const Made& made) {
  require_enough_joints<Space>(state.q.size());
  require_xdd(scheme, xdd);
  auto reference = Reference<Space>::hold(point<Space>(x, "x"));
  reference.xd = fixed_vector<Space::kRows>(xd, "xd");
  if (xdd) reference.xdd = fixed_vector<Space::kRows>(*xdd, "xdd");
  Array result = result_array(out, {state.q.size()});
  JointVector u = JointVector::Zero(state.q.size());
  const EitherScheme<Space>& either = made(Space{});
  const Status status =
      std::visit([&](const auto& any) { return any.resolve(kinematics, reference, state, u); }, either);
  if (failed(status)) raise(status);
  Eigen::Map<Eigen::VectorXd>(result.mutable_data(), u.size()) = u;
  return result;
}

/// Finite numbers of one shape: one value for each state, or one value for all states.
class PerState {
 public:
  using Shape = std::vector<py::ssize_t>;

  PerState(const ArrayLike& given, const char* name, const Shape& shape, py::ssize_t states)
      : shared_(dimensions(given) == static_cast<int>(shape.size())),
        values_(real_array(given, name, static_cast<int>(shape.size()) + (shared_ ? 0 : 1))),
        size_(values_.size() / (shared_ ? 1 : std::max<py::ssize_t>(values_.shape(0), 1))) {
    Shape required = shape;
    if (!shared_) required.insert(required.begin(), states);
    for (std::size_t i = 0; i < required.size(); ++i) {
      if (values_.shape(static_cast<py::ssize_t>(i)) == required[i]) continue;
      std::string text;
      for (const py::ssize_t each : required) text += (text.empty() ? "" : ", ") + std::to_string(each);
      if (required.size() == 1) text += ",";
      validation::reject(name, ": must have shape (" + text + "), got " + shape_text(values_));
    }
    for (py::ssize_t i = 0; i < values_.size(); ++i) {
      const double value = values_.data()[i];
      if (std::isfinite(value)) continue;
      const validation::Argument state = validation::element(name, shared_ ? i % size_ : i / size_);
      validation::fail(state, value, "finite");
    }
  }

  [[nodiscard]] const double* at(py::ssize_t state) const noexcept {
    return values_.data() + (shared_ ? 0 : state * size_);
  }

 private:
  bool shared_;
  py::array_t<double, py::array::c_style> values_;
  py::ssize_t size_;
};

/// A point of a task space from plain numbers.
template <typename Space>
typename Space::template Point<double> point_at(const PerState& x, py::ssize_t state) {
  const double* values = x.at(state);
  if constexpr (std::is_same_v<Space, Pose>) {
    return transform_of(Eigen::Map<const RowMajor>(values, 4, 4), [state] { return validation::element("x", state); });
  } else {
    return Eigen::Map<const Vector<Space::kSize>>(values);
  }
}

/// resolve() in many states. An argument with one value holds for all states.
template <typename Space, typename Any>
Array resolve_many(const Scheme& scheme, const Any& arm, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                   const ArrayLike& xd, const OptionalArray& xdd, const OptionalOut& out) {
  const py::ssize_t dof = arm.dof();
  require_enough_joints<Space>(dof);
  require_xdd(scheme, xdd);
  const py::ssize_t states = real_array(q, "q", 2).shape(0);
  const PerState qs(q, "q", {dof}, states);
  const PerState qds(qd, "qd", {dof}, states);
  const PerState points(x, "x", std::is_same_v<Space, Pose> ? PerState::Shape{4, 4} : PerState::Shape{Space::kSize},
                        states);
  const PerState xds(xd, "xd", {Space::kRows}, states);
  std::optional<PerState> xdds;
  if (xdd) xdds.emplace(*xdd, "xdd", PerState::Shape{Space::kRows}, states);
  const EitherScheme<Space> either = scheme.make<Space>(arm);
  Array result = result_array(out, {states, dof});
  std::visit(
      [&](const auto& any) {
        using Row = Eigen::Map<const Vector<Space::kRows>>;
        Kinematics<Space, kDynamic> kinematics;
        State<kDynamic> state;
        JointVector u = JointVector::Zero(dof);
        for (py::ssize_t i = 0; i < states; ++i) {
          state.q = Eigen::Map<const Eigen::VectorXd>(qs.at(i), dof);
          state.qd = Eigen::Map<const Eigen::VectorXd>(qds.at(i), dof);
          arm.kinematics(state.q, state.qd, kinematics);
          auto reference = Reference<Space>::hold(point_at<Space>(points, i));
          reference.xd = Row(xds.at(i));
          if (xdds) reference.xdd = Row(xdds->at(i));
          const Status status = any.resolve(kinematics, reference, state, u);
          if (failed(status)) raise(status, "state " + std::to_string(i) + ": ");
          Eigen::Map<Eigen::VectorXd>(result.mutable_data(i), dof) = u;
        }
      },
      either);
  return result;
}

}  // namespace

Array resolve_for_arm(const Scheme& scheme, const Arm& arm, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                      const ArrayLike& xd, const OptionalArray& xdd, const std::string& task, const OptionalOut& out) {
  return arm.visit(task, [&](const auto& any, auto space) {
    using Space = decltype(space);
    if (py::isinstance<py::array>(q) ? py::array(q).ndim() == 2 : dimensions(q) == 2) {
      return resolve_many<Space>(scheme, any, q, qd, x, xd, xdd, out);
    }
    const State<kDynamic> state{joint_vector(q, "q", arm.dof()), joint_vector(qd, "qd", arm.dof())};
    Kinematics<Space, kDynamic> kinematics;
    any.kinematics(state.q, state.qd, kinematics);
    std::optional<EitherScheme<Space>> of_arm;
    return resolve(scheme, kinematics, state, x, xd, xdd, out, [&](auto) -> const EitherScheme<Space>& {
      return scheme.needs_arm() ? of_arm.emplace(scheme.make<Space>(any))
                                : scheme.kept<Space>(arm.dof(), any.limits().continuous);
    });
  });
}

Array resolve_for_kinematics(const Scheme& scheme, const AnyKinematics& kinematics, const ArrayLike& q,
                             const ArrayLike& qd, const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd,
                             const OptionalOut& out) {
  if (!kinematics.has_rate && scheme.level == Level::kAcceleration) {
    validation::reject("Jd", ": must be given for an acceleration-level scheme");
  }
  return std::visit(
      [&](const auto& known) {
        const auto dof = static_cast<int>(known.J.cols());
        const State<kDynamic> state{joint_vector(q, "q", dof), joint_vector(qd, "qd", dof)};
        return resolve(
            scheme, known, state, x, xd, xdd,
            out, [&](auto space) -> const auto& { return scheme.kept<decltype(space)>(dof); });
      },
      kinematics.value);
}

}  // namespace fpbm::bindings
