#pragma once

#include <algorithm>
#include <cmath>
#include <fpbm/core/types.hpp>
#include <fpbm/model/dynamics.hpp>

namespace fpbm_controllers {

/// Torques of the drives for a commanded motion (q_c, q̇_c, q̈_c) and a measured state (q, q̇):
///
///   τ = M(q) (q̈_c + K_p (q_c − q) + K_d (q̇_c − q̇)) + h(q, q̇)
///
/// If all gains are 0, the commanded state replaces the measured state: τ is the feed-forward torque of the command.
/// Only the constructor allocates.
class ComputedTorque {
 public:
  static constexpr int kDof = Eigen::Dynamic;
  using Joints = fpbm::Vector<kDof>;
  using Model = fpbm::Dynamics<kDof>;

  struct Settings {
    Joints kp;                        ///< [1/s²]
    Joints kd;                        ///< [1/s]
    Joints effort;                    ///< Bounds on the torques of the drives [Nm] or [N].
    bool robot_adds_gravity = false;  ///< If true, the torques do not contain gravity.
  };

  ComputedTorque(const Model& model, const Settings& settings)
      : model_(model),
        settings_(settings),
        has_feedback_((settings.kp.array() > 0.0).any() || (settings.kd.array() > 0.0).any()),
        torque_(Joints::Zero(model.dof())) {}

  [[nodiscard]] bool has_feedback() const noexcept { return has_feedback_; }
  [[nodiscard]] const Joints& torque() const noexcept { return torque_; }

  /// Computes the torques of a tick. command: at the start of the tick. qdd: commanded acceleration. Returns the bits
  /// of the joints whose torques are limited to the bounds.
  fpbm::JointBits tick(const fpbm::State<kDof>& command, const Joints& qdd,
                       const fpbm::State<kDof>& measured) noexcept {
    const fpbm::State<kDof>& at = has_feedback_ ? measured : command;
    Joints acceleration = qdd;
    for (Eigen::Index i = 0; i < qdd.size(); ++i) {
      acceleration(i) += settings_.kp(i) * (command.q(i) - at.q(i)) + settings_.kd(i) * (command.qd(i) - at.qd(i));
    }
    model_.robot().update(at.q, at.qd, state_);
    torque_ = model_.inverse_dynamics(state_, acceleration);
    fpbm::JointBits limited = 0;
    for (Eigen::Index i = 0; i < qdd.size(); ++i) {
      const double most = settings_.effort(i);
      if (std::abs(torque_(i)) > most) limited |= fpbm::joint_bit(i);
      torque_(i) = std::clamp(torque_(i), -most, most);
    }
    if (settings_.robot_adds_gravity) torque_ -= model_.gravity_torque(state_);
    return limited;
  }

 private:
  Model model_;
  Settings settings_;
  bool has_feedback_;
  Model::State state_;
  Joints torque_;
};

}  // namespace fpbm_controllers
