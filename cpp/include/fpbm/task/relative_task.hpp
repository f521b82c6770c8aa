#pragma once

#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_rows.hpp"
#include "fpbm/task/pose_task.hpp"

namespace fpbm {

/// View of a robot from one of its frames: all functions of Robot that tasks of frames call, with results in this
/// frame.
template <typename Robot_>
class RelativeView {
 public:
  using Scalar = typename Robot_::Scalar;
  using State = typename Robot_::State;
  using Vector3 = Vector<3, Scalar>;

  RelativeView(const Robot_& robot, const State& state, const LinkFrame<Scalar>& reference) noexcept
      : robot_(robot),
        link_(reference.link()),
        at_(reference.at(robot, state)),
        back_(transposed(at_.R)),
        w_(robot.angular_velocity(state, link_)) {}

  [[nodiscard]] int dof() const noexcept { return robot_.dof(); }
  [[nodiscard]] Scalar length() const noexcept { return robot_.length(); }

  [[nodiscard]] Transform<Scalar> frame(const State& state, int link, const Transform<Scalar>& seen) const noexcept {
    return inverse(at_) * robot_.frame(state, link, seen);
  }
  [[nodiscard]] Matrix<3, 3, Scalar> axes(const State& state, int link,
                                          const Matrix<3, 3, Scalar>& seen) const noexcept {
    return times(back_, robot_.axes(state, link, seen));
  }
  [[nodiscard]] Vector3 point(const State& state, int link, const Vector3& seen) const noexcept {
    return times(back_, subtract(robot_.point(state, link, seen), at_.p));
  }
  [[nodiscard]] Vector3 angular_velocity(const State& state, int link) const noexcept {
    return times(back_, subtract(robot_.angular_velocity(state, link), w_));
  }

  /// Robot::columns() in the reference frame: J = Rᵀ(J_b − J_a), where J_b is the Jacobian of the point p of the link,
  /// and J_a the Jacobian of the point of the reference link that coincides with p. v = (J_b − J_a) q̇ is the velocity
  /// of p relative to the reference link, w the angular velocity of the reference link, and aᵢ the angular part of
  /// column i of J_a. Then (docs/kinematics.md, Time derivative of J, Between two frames)
  ///
  ///   J̇ = Rᵀ(J̇_b − J̇_a − (aᵢ × v; 0)ᵢ − w × (J_b − J_a)).
  template <typename F>
  Vector3 columns(const State& state, int link, const Vector3& p, const F& f) const noexcept {
    using Columns = typename Robot_::Columns;
    using Two = Pair<Scalar>;
    struct Difference {
      Columns J;
      Columns Jd;
      Columns own;
    };
    Difference differences[(kCapacity<Robot_::kDof> + 1) / 2];
    const Vector3 turned = times(at_.R, p);
    const Vector3 place = entrywise(p, [&](Eigen::Index i) { return at_.p.coeff(i) + turned.coeff(i); });
    const Vector3 carried =
        robot_.columns(state, link_, place, [&](Eigen::Index j, const Columns& own, const Columns& rates) noexcept {
          differences[j / 2].own = own;
          differences[j / 2].Jd = rates;
        });
    const Vector3 moved =
        robot_.columns(state, link, place, [&](Eigen::Index j, const Columns& columns, const Columns& rates) noexcept {
          Difference& at = differences[j / 2];
          at.J = columns - at.own;
          at.Jd = rates - at.Jd;
        });
    const Vector3 v = subtract(moved, carried);
    const auto twice = [](const Vector3& x) noexcept {
      return Vector<3, Two>{Two(x.coeff(0)), Two(x.coeff(1)), Two(x.coeff(2))};
    };
    const auto w = twice(w_);
    const auto pd = twice(v);
    for (Eigen::Index j = 0; j < dof(); j += 2) {
      const Difference& at = differences[j / 2];
      const Columns drift{sum_of(cross<Two>(at.own.angular, pd), cross<Two>(w, at.J.linear)),
                          cross<Two>(w, at.J.angular)};
      f(j, seen(at.J), seen(at.Jd - drift));
    }
    return times(back_, v);
  }

  template <typename F>
  void angular_columns(const State& state, int link, const F& f) const noexcept {
    (void)columns(
        state, link, filled<Vector3>(3),
        [&](Eigen::Index j, const auto& columns, const auto& rates) noexcept { f(j, columns.angular, rates.angular); });
  }

 private:
  /// Rᵀ times a pair of columns.
  template <typename Columns>
  [[nodiscard]] Columns seen(const Columns& columns) const noexcept {
    const auto turned = [&](const auto& of) noexcept {
      return entrywise(of, [&](Eigen::Index i) { return along(column(at_.R, i), of); });
    };
    return {turned(columns.linear), turned(columns.angular)};
  }
  [[nodiscard]] static Vector3 subtract(const Vector3& a, const Vector3& b) noexcept {
    return entrywise(a, [&](Eigen::Index i) { return a.coeff(i) - b.coeff(i); });
  }

  const Robot_& robot_;
  int link_;
  Transform<Scalar> at_;  ///< Pose of the reference frame in the base frame.
  Matrix<3, 3, Scalar> back_;
  Vector3 w_;  ///< Angular velocity of the reference frame, along the axes of the base frame [rad/s].
};

/// Throws std::invalid_argument if no joint moves a frame relative to the other frame.
template <typename Robot, typename Scalar>
void require_relative_motion(const Robot& robot, const LinkFrame<Scalar>& frame, const LinkFrame<Scalar>& reference) {
  if (robot.moved_by(frame.link()) == robot.moved_by(reference.link())) {
    validation::reject("reference_frame", ": moves with the task's frame: must be on another link");
  }
}

/// Task of a frame relative to another frame of the robot, the reference frame, which may move. The task is a
/// PositionTask, OrientationTask, PoseTask or AxisTask. The point, reference and rows of the task are in the reference
/// frame instead of the base frame.
template <typename Task>
struct RelativeTask {
  using Scalar = typename Task::Scalar;
  using Space = typename Task::Space;
  static constexpr int kRows = Task::kRows;
  static constexpr bool kWhole = Task::kWhole;

  Task task;
  LinkFrame<Scalar> reference;
  TaskGains<Scalar> gains = task.gains;

  /// Throws std::invalid_argument if a frame does not exist in the robot, or if no joint moves the frames relative to
  /// each other.
  template <typename Robot>
  void bind(const Robot& robot) {
    task.bind(robot);
    reference.bind(robot);
    require_relative_motion(robot, task.frame, reference);
  }

  template <typename Robot, typename Point, typename Velocity, typename Selection, typename Rows>
  void evaluate(const Robot& robot, const typename Robot::State& state, Point& x, Velocity& xd, Selection& S,
                Rows level) const noexcept {
    task.evaluate(RelativeView<Robot>(robot, state, reference), state, x, xd, S, level);
  }
};

template <typename Task>
RelativeTask(const Task&, const LinkFrame<typename Task::Scalar>&) -> RelativeTask<Task>;

/// Pose of a frame in another frame of the robot, for example of one hand relative to the other hand.
template <typename Scalar = double>
using RelativePoseTask = RelativeTask<PoseTask<Scalar>>;

}  // namespace fpbm
