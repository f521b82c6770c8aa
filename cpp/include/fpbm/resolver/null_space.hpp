#pragma once

#include "fpbm/core/validation.hpp"

namespace fpbm {

/// What a scheme returns: joint velocities or joint accelerations.
enum class Level : unsigned char { kVelocity, kAcceleration };

/// Secondary motion z, which the schemes project on the null space of the task. Zero by default.
///
///   acceleration level: z = c − kₙ qd + kₚ (q_rest − q)        velocity level: z = c + kₚ (q_rest − q)
///
/// Damping kₙ [1/s] brings the self-motion to rest, the rest posture draws the arm to q_rest [rad] with stiffness kₚ
/// ([1/s²], or [1/s] at velocity level), and c ([rad/s²], or [rad/s]) is the free choice in the general solutions
/// (3) and (5). The with_… functions return a changed copy and throw std::invalid_argument on a bad value.
template <int N, typename Scalar = double>
class NullSpace {
 public:
  [[nodiscard]] NullSpace with_damping(Scalar damping) const {
    validation::require_non_negative("null_damping", static_cast<double>(damping));
    NullSpace changed = *this;
    changed.damping_ = damping;
    return changed;
  }

  [[nodiscard]] NullSpace with_rest_posture(const Vector<N, Scalar>& q_rest, Scalar stiffness) const {
    validation::require_finite("rest_posture", q_rest);
    validation::require_positive("null_stiffness", static_cast<double>(stiffness));
    NullSpace changed = with_constant(stiffness * q_rest);
    changed.stiffness_ = stiffness_ + stiffness;
    return changed;
  }

  [[nodiscard]] NullSpace with_free_choice(const Vector<N, Scalar>& c) const {
    validation::require_finite("c", c);
    return with_constant(c);
  }

  /// Throws std::invalid_argument where z is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    if (has_constant_) validation::require_size("rest_posture or c", constant_.size(), dof);
  }

  /// False where z is zero whatever the state.
  template <Level kLevel>
  [[nodiscard]] bool active() const noexcept {
    return has_constant_ || (kLevel == Level::kAcceleration && damping_ != Scalar(0));
  }

  /// z in this state.
  template <Level kLevel>
  [[nodiscard]] Vector<N, Scalar> at(const State<N, Scalar>& state) const noexcept {
    Vector<N, Scalar> z = Vector<N, Scalar>::Zero(state.q.size());
    if (has_constant_) z += constant_ - stiffness_ * state.q;
    if constexpr (kLevel == Level::kAcceleration) z -= damping_ * state.qd;
    return z;
  }

 private:
  [[nodiscard]] NullSpace with_constant(const Vector<N, Scalar>& added) const {
    NullSpace changed = *this;
    if (has_constant_) {
      validation::require_size("rest_posture or c", added.size(), constant_.size());
      changed.constant_ += added;
    } else {
      changed.constant_ = added;
    }
    changed.has_constant_ = true;
    return changed;
  }

  Scalar damping_{0};
  Scalar stiffness_{0};
  bool has_constant_ = false;
  Vector<N, Scalar> constant_ = Vector<N, Scalar>::Zero(N == Eigen::Dynamic ? 0 : N);  ///< c + kₚ q_rest.
};

}  // namespace fpbm
