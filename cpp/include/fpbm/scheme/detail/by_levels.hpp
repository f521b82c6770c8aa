#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/level_space.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/scheme/detail/require_members.hpp"
#include "fpbm/scheme/detail/task_equation.hpp"
#include "fpbm/singular/detail/damped_level.hpp"
#include "fpbm/singular/detail/scaled_level.hpp"
#include "fpbm/task/detail/stack_kinematics.hpp"

namespace fpbm {

/// Scheme for a stack of tasks. The law of `scheme` resolves the first level. Each lower level acts in the null space
/// of the higher levels (Siciliano and Slotine 1991):
///
///   u_k = u_{k−1} + Z (J_k Z)⁺ (b_k − J_k u_{k−1}),   Z a basis of the null space of J₁ … J_{k−1},
///
/// with b_k = S (xdd + k₁(xd − ẋ) + k₂(x ⊖ f(q))) − J̇_k qd for each task, or b_k = S (xd + k (x ⊖ f(q))) at velocity
/// level, all rows in metres. In a tick, continue_tick() defines b_k and J_k. Directions of a level that are lost
/// because of the posture or of higher levels are damped (DampedLevel). The null-space motion of `scheme` determines
/// the motion that no task determines: while directions of a lower level are damped, the posture-dependent part of z is
/// projected on the null space of all levels (docs/singularities.md, Secondary motion).
template <typename Scheme, typename Stack_>
struct ByLevels {
  using Scalar = typename Stack_::Scalar;
  static constexpr Level kLevel = Scheme::kLevel;
  static constexpr int kDof = Scheme::kDof;
  using JointVector = Vector<kDof, Scalar>;
  using Space = typename Stack_::Space;
  static_assert(require_members_for_stack<Scheme, Stack_::kRows[0], kDof, Scalar>());

  Scheme scheme;
  Scalar radius;  ///< ε of the damping of lower levels, for the rows of ScaledLevel.

  /// scheme: without feedback gains, since the tasks have gains. Throws std::invalid_argument unless 0 ≤ radius ≤ 1.
  explicit ByLevels(const Scheme& scheme_, Scalar radius_ = kLevelRadius<Scalar>) : scheme(scheme_), radius(radius_) {
    validation::require_fraction("radius", radius);
  }

  void require_dof(Eigen::Index dof) const { scheme.require_dof(dof); }

  /// Joint accelerations [rad/s²], or velocities [rad/s]. A level whose references are not finite is ignored. If the
  /// first level fails, u does not change. first: set to the motion of the first level alone, unless null.
  [[nodiscard]] Status resolve(const Kinematics<Space, kDof, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<kDof, Scalar>& state,
                               JointVector& u, JointVector* first = nullptr) const noexcept {
    JointVector result;
    bool damped = false;
    Status status = resolve_levels(kinematics, reference, state, false, damped, result, first);
    if (damped && !failed(status) && moves_at_rest(scheme)) {
      status = resolve_levels(kinematics, reference, state, true, damped, result, first);
    }
    if (failed(status)) return status;
    if (!is_finite(result)) return Status::kNotFinite;
    u = std::move(result);
    return status;
  }

 private:
  /// Resolves all levels. Sets `damped` if directions of a lower level are damped. apart: whether the lower levels are
  /// resolved without the posture-dependent part of z, which is then projected on the null space of all levels and
  /// multiplied by DampedLevel::fade() of each level. Otherwise, the damped pseudoinverse of a lower level would not
  /// remove this part from the level.
  [[nodiscard]] Status resolve_levels(const Kinematics<Space, kDof, Scalar>& kinematics,
                                      const Reference<Space, Scalar>& reference, const State<kDof, Scalar>& state,
                                      bool apart, bool& damped, JointVector& result,
                                      JointVector* first) const noexcept {
    LevelSpace<kDof, Scalar> space(state.q.size());
    JointVector secondary;
    Status status = Status::kOk;
    Scalar fade(1);
    each(Constant<0>{}, Constant<Stack_::kLevels>{}, [&](auto k) noexcept {
      constexpr int kIndex = decltype(k)::kIndex;
      const auto& level = std::get<kIndex>(kinematics.levels);
      constexpr int M = Stack_::kRows[kIndex];
      if (kIndex > 0 && (failed(status) || !kinematics.enabled[kIndex] || level.rows() == 0)) return;
      auto xd = filled<Vector<M, Scalar>>(level.rows());
      auto r = filled<Vector<M, Scalar>>(level.rows());
      command_level<kIndex>(kinematics, reference, xd, r);
      subtract_drift(kinematics.tick, level, state.qd, r);
      if constexpr (kIndex == 0) {
        result = filled<JointVector>(state.q.size());
        status = scheme.resolve_rows(TaskEquation<M, kDof, Scalar>{level.J, level.Jd, r, xd}, state, result);
        if (first != nullptr) *first = result;
        if (apart) {
          secondary = secondary_motion(level, state.q);
          result -= secondary;
        }
        if constexpr (Stack_::kLevels > 1) space.add(level.J);
      } else {
        if (space.rank() < space.size()) result += added(level, r, result, space, fade, damped);
      }
    });
    if (apart) result += fade * space.project(secondary);
    return status;
  }

  /// Posture-dependent part of the null-space motion of the scheme: the motion at rest without a command.
  template <typename LevelRows_>
  [[nodiscard, gnu::cold, gnu::noinline]] JointVector secondary_motion(const LevelRows_& level,
                                                                       const JointVector& q) const noexcept {
    constexpr int M = Stack_::kRows[0];
    const auto nothing = filled<Vector<M, Scalar>>(level.rows());
    auto motion = filled<JointVector>(q.size());
    const State<kDof, Scalar> at_rest{q, motion};
    const TaskEquation<M, kDof, Scalar> task{level.J, level.Jd, nothing, nothing};
    const Status status = scheme.resolve_rows(task, at_rest, motion);
    return failed(status) ? filled<JointVector>(q.size()) : motion;
  }

  /// r −= J̇ qd at acceleration level, or r −= drift in a tick. J̇ of a posture is 0.
  template <typename Rows_, int M>
  static void subtract_drift(Scalar tick, const Rows_& level, const JointVector& qd, Vector<M, Scalar>& r) noexcept {
    if (tick > Scalar(0)) {
      r -= level.drift;
    } else if constexpr (kLevel == Level::kAcceleration && !std::is_same_v<Rows_, PostureRows<kDof, Scalar>>) {
      r -= product(level.Jd, qd);
    }
  }

  /// Returns u_k − u_{k−1} of a lower level, and adds the level to the space. Returns zero if the rows are not finite.
  /// r: b_k. Multiplies `fade` by DampedLevel::fade(), and sets `damps` if directions are damped.
  template <int M>
  [[nodiscard]] JointVector added(const LevelRows<M, kDof, Scalar>& level, Vector<M, Scalar> r, const JointVector& u,
                                  LevelSpace<kDof, Scalar>& space, Scalar& fade, bool& damps) const noexcept {
    r -= product(level.J, u);
    if (!r.allFinite()) return filled<JointVector>(u.size());
    const ScaledLevel<M, kDof, Scalar> scaled(level.J, r);
    DampedLevel<M, Scalar> damped(radius * radius);
    const JointVector y = space.add(scaled.J, scaled.r, damped);
    fade *= damped.fade();
    damps = damps || damped.damps();
    return y;
  }
  /// added() for a posture of all joints: J Z has orthonormal columns.
  [[nodiscard]] JointVector added(const PostureRows<kDof, Scalar>& level, const JointVector& r, const JointVector& u,
                                  LevelSpace<kDof, Scalar>& space, Scalar&, bool&) const noexcept {
    if (!r.allFinite()) return filled<JointVector>(u.size());
    JointVector y = u;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const int joint = level.joints[static_cast<std::size_t>(i)];
      y.coeffRef(joint) = r.coeff(i) - u.coeff(joint);
    }
    return space.add_unit(y);
  }

  /// Commands of the tasks of level k: xd, and b_k without the drift.
  template <int k, int M>
  void command_level(const Kinematics<Space, kDof, Scalar>& kinematics, const Reference<Space, Scalar>& reference,
                     Vector<M, Scalar>& to_xd, Vector<M, Scalar>& to_b) const noexcept {
    Eigen::Index to_row = 0;
    Space::each([&](auto space, auto i, int row) noexcept {
      using Part = decltype(space);
      constexpr int kTask = static_cast<int>(decltype(i)::value);
      if constexpr (Stack_::level(kTask) == k) {
        const auto& task = std::get<kTask>(kinematics.tasks);
        if (task.S.rows() == 0) return;
        using Twist = Vector<Part::kRows, Scalar>;
        const Twist error =
            Part::template difference<Scalar>(std::get<kTask>(reference.x), std::get<kTask>(kinematics.tip));
        const Twist xd = reference.xd.template segment<Part::kRows>(row);
        const Twist xdd = reference.xdd.template segment<Part::kRows>(row);
        const auto put = [&](Vector<M, Scalar>& to, const auto& entry) noexcept {
          if constexpr (std::tuple_element_t<kTask, typename Stack_::Tasks>::kWhole) {
            for (Eigen::Index j = 0; j < task.S.rows(); ++j) to.coeffRef(to_row + j) = task.S.coeff(j, j) * entry(j);
          } else {
            const Twist twist = entrywise(xd, entry);
            const auto rows = product(task.S, twist);
            for (Eigen::Index j = 0; j < rows.size(); ++j) to.coeffRef(to_row + j) = rows.coeff(j);
          }
        };
        if constexpr (kLevel == Level::kAcceleration) {
          put(to_xd, [&](Eigen::Index j) { return xd.coeff(j); });
          const auto& feedback = task.feedback;
          const bool in_tick = TickFeedback<Scalar>::kByPositions && kinematics.tick > Scalar(0);
          put(to_b, [&](Eigen::Index j) {
            const Scalar error_rate = in_tick ? kinematics.error_rate.coeff(row + j) : xd.coeff(j) - task.xd.coeff(j);
            return (Scalar(1) - feedback.previous_weight) * xdd.coeff(j) + feedback.velocity_gain * error_rate +
                   feedback.position_gain * error.coeff(j);
          });
        } else {
          put(to_b, [&](Eigen::Index j) { return xd.coeff(j) + task.feedback.position_gain * error.coeff(j); });
        }
        to_row += task.S.rows();
      }
    });
  }
};

}  // namespace fpbm
