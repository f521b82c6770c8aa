#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/model/detail/continuous_joints.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Secondary motion z, which the schemes project onto the null space of the task. Zero by default.
///
///   acceleration level: z = c − kₙ qd + kₚ (q_rest − q) − k_c ∇H    velocity level: the same without kₙ qd
///
/// The damping kₙ [1/s] stops the self-motion. The rest posture q_rest [rad] attracts the joints with the stiffness kₚ
/// ([1/s²], or [1/s] at velocity level). Centring moves the joints away from their bounds. c ([rad/s²], or [rad/s]) is
/// the free choice in the general solutions (3) and (5) of docs/equations.md. Differences of the positions of
/// continuous joints are modulo 2π: a tracker, a rollout and Python set these joints. Each function with_… returns a
/// copy with one more part, and throws std::invalid_argument if a value is out of range.
///
/// Repetitive motion planning (Zhang and others, Mechatronics 18, 2008) removes the drift of the joints on closed
/// paths. With the gain λ, repetitive motion planning equals a rest posture at the start posture: at velocity level
/// with stiffness λ, at acceleration level with stiffness λ² and damping 2λ (critical damping).
template <int N, typename Scalar = double>
class NullSpace {
 public:
  [[nodiscard]] NullSpace with_damping(Scalar damping) const {
    validation::require_non_negative("null_damping", damping);
    NullSpace changed = *this;
    changed.damping_ += damping;
    changed.has_damping_ = !all_of(changed.damping_ == Scalar(0));
    return changed;
  }

  [[nodiscard]] NullSpace with_rest_posture(const Vector<N, Scalar>& q_rest, Scalar stiffness) const {
    validation::require_finite("rest_posture", q_rest);
    validation::require_positive("null_stiffness", stiffness);
    return with_spring(filled<Vector<N, Scalar>>(q_rest.size(), stiffness), q_rest);
  }

  /// Attracts each joint to the middle of its bounds, along −∇H with H = ½ Σ ((qᵢ − q̄ᵢ)/(uᵢ − lᵢ))² and q̄ = (l + u)/2
  /// (Liégeois 1977), times k_c = gain [rad²/s²], or [rad²/s] at velocity level. A joint with an infinite bound is
  /// omitted.
  [[nodiscard]] NullSpace with_joint_centring(const JointLimits<N, Scalar>& limits, Scalar gain) const {
    validation::require_positive("joint_centring", gain);
    const Eigen::Index dof = limits.lower.size();
    validation::require_size("limits.upper", limits.upper.size(), dof);
    Vector<N, Scalar> stiffness = filled<Vector<N, Scalar>>(dof);
    Vector<N, Scalar> middle = filled<Vector<N, Scalar>>(dof);
    for (Eigen::Index i = 0; i < dof; ++i) {
      const Scalar range = limits.upper(i) - limits.lower(i);
      if (!(range > Scalar(0))) {
        validation::fail(validation::element("limits.lower", i), limits.lower(i), "below limits.upper");
      }
      if (!std::isfinite(static_cast<double>(range))) continue;
      stiffness(i) = gain / (range * range);
      middle(i) = limits.lower(i) + range / Scalar(2);
    }
    return with_spring(stiffness, middle);
  }

  [[nodiscard]] NullSpace with_free_choice(const Vector<N, Scalar>& c) const {
    validation::require_finite("c", c);
    return with_constant(c);
  }

  /// A copy with a further constant part of z, for as many joints as z.
  [[nodiscard]] NullSpace plus(const Vector<N, Scalar>& added) const noexcept {
    NullSpace changed = *this;
    if (!has_constant_) {
      changed.constant_ = changed.stiffness_ = changed.rest_ = filled<Vector<N, Scalar>>(added.size());
      changed.has_constant_ = true;
    }
    changed.constant_ += added;
    return changed;
  }

  /// Bits of the continuous joints, for the rest posture.
  [[nodiscard]] NullSpace with_continuous_joints(JointBits joints) const {
    NullSpace changed = *this;
    changed.continuous_ = joints;
    return changed;
  }

  /// Null space with lanes: get(lane) returns the null space of one lane.
  template <typename Get>
  [[nodiscard]] static NullSpace side_by_side(const Get& get) {
    NullSpace result;
    const Eigen::Index dof = get(0).constant_.size();
    result.damping_ = Scalar([&](auto lane) { return get(lane).damping_; });
    for (std::size_t lane = 0; lane < Scalar::size(); ++lane) {
      result.has_damping_ |= get(lane).has_damping_;
      result.has_constant_ |= get(lane).has_constant_;
      result.continuous_ |= get(lane).continuous_;
    }
    for (Eigen::Index i = 0; i < dof; ++i) {
      result.stiffness_(i) = Scalar([&](auto lane) { return get(lane).stiffness_(i); });
      result.constant_(i) = Scalar([&](auto lane) { return get(lane).constant_(i); });
      result.rest_(i) = Scalar([&](auto lane) { return get(lane).rest_(i); });
    }
    return result;
  }

  /// Throws std::invalid_argument if z is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    if (has_constant_) validation::require_size("rest_posture, limits or c", constant_.size(), dof);
  }

  /// kₙ [1/s].
  [[nodiscard]] const Scalar& damping() const noexcept { return damping_; }

  /// Smallest and largest stiffness of a joint, as the sum of rest posture and centring ([1/s²], or [1/s] at velocity
  /// level).
  [[nodiscard]] std::pair<Scalar, Scalar> stiffness_range() const noexcept {
    if (stiffness_.size() == 0) return {Scalar(0), Scalar(0)};
    std::pair<Scalar, Scalar> range{stiffness_(0), stiffness_(0)};
    for (Eigen::Index i = 1; i < stiffness_.size(); ++i) {
      range = {std::min(range.first, stiffness_(i)), std::max(range.second, stiffness_(i))};
    }
    return range;
  }

  /// False if z is zero in every state.
  template <Level kLevel>
  [[nodiscard]] bool active() const noexcept {
    return has_constant_ || (kLevel == Level::kAcceleration && has_damping_);
  }

  /// z in a state. At velocity level, z is the part that depends on the posture: z without kₙ qd.
  template <Level kLevel>
  [[nodiscard]] Vector<N, Scalar> at(const State<N, Scalar>& state) const noexcept {
    Vector<N, Scalar> z = entrywise(state.q, [](Eigen::Index) { return Scalar(0); });
    if (has_constant_) {
      z = entrywise(z, [&](Eigen::Index i) {
        return z.coeff(i) + (constant_.coeff(i) - stiffness_.coeff(i) * state.q.coeff(i));
      });
      if (continuous_ != 0) remove_turns(state.q, z);
    }
    if constexpr (kLevel == Level::kAcceleration) {
      z = entrywise(z, [&](Eigen::Index i) { return z.coeff(i) - damping_ * state.qd.coeff(i); });
    }
    return z;
  }

  /// Part of z that depends on the velocities, with additional damping: −(kₙ + brake) qd, or zero at velocity level.
  template <Level kLevel>
  [[nodiscard]] Vector<N, Scalar> velocity_part(const State<N, Scalar>& state, const Scalar& brake) const noexcept {
    const Scalar damping = kLevel == Level::kAcceleration ? damping_ + brake : Scalar(0);
    return entrywise(state.q, [&](Eigen::Index i) {
      return kLevel == Level::kAcceleration ? Scalar(-damping * state.qd.coeff(i)) : Scalar(0);
    });
  }

 private:
  template <int, typename>
  friend class NullSpace;

  /// Adds stiffness ∘ (middle − q), entrywise.
  [[nodiscard]] NullSpace with_spring(const Vector<N, Scalar>& stiffness, const Vector<N, Scalar>& middle) const {
    NullSpace changed = with_constant(entrywise(middle, [&](Eigen::Index i) { return stiffness(i) * middle(i); }));
    for (Eigen::Index i = 0; i < middle.size(); ++i) {
      const Scalar before = changed.stiffness_(i);
      changed.stiffness_(i) += stiffness(i);
      if (all_of(changed.stiffness_(i) > Scalar(0))) {
        changed.rest_(i) = (before * changed.rest_(i) + stiffness(i) * middle(i)) / changed.stiffness_(i);
      }
    }
    return changed;
  }

  /// Removes whole turns of continuous joints from the differences q_rest − q in z.
  [[gnu::noinline]] void remove_turns(const Vector<N, Scalar>& q, Vector<N, Scalar>& z) const noexcept {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      if ((continuous_ >> i & 1U) == 0) continue;
      z.coeffRef(i) -= stiffness_.coeff(i) * whole_turns(Scalar(rest_.coeff(i) - q.coeff(i)));
    }
  }

  [[nodiscard]] NullSpace with_constant(const Vector<N, Scalar>& added) const {
    if (has_constant_) validation::require_size("rest_posture, limits or c", added.size(), constant_.size());
    return plus(added);
  }

  static constexpr Eigen::Index kSize = N == Eigen::Dynamic ? 0 : N;

  JointBits continuous_ = 0;
  Scalar damping_{0};
  bool has_damping_ = false;
  bool has_constant_ = false;
  Vector<N, Scalar> stiffness_ = filled<Vector<N, Scalar>>(kSize);  ///< Per joint.
  Vector<N, Scalar> constant_ = filled<Vector<N, Scalar>>(kSize);   ///< c + kₚ q_rest + constant part of centring.
  Vector<N, Scalar> rest_ = filled<Vector<N, Scalar>>(kSize);       ///< Position at which the springs have no force.
};

}  // namespace fpbm
