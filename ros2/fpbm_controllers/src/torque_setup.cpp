#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm_controllers/description.hpp"
#include "fpbm_controllers/target_controller.hpp"

namespace fpbm_controllers {

namespace {

using Joints = ComputedTorque::Joints;

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument(message);
}

[[nodiscard]] fpbm::Vector<3> three(const char* name, const std::vector<double>& values) {
  const fpbm::Vector<3> result(values.at(0), values.at(1), values.at(2));
  require(result.allFinite(), std::string(name) + ": has a number that is not finite: give three finite numbers");
  return result;
}

/// Throws unless a tick damps the error e of a joint: e'' = −kp e − kd e', where e'' is constant within a tick.
void require_stable(const std::string& joint, double kp, double kd, double dt) {
  const double least = kp * dt / 2.0;
  if ((kp == 0.0 && kd == 0.0) || (least < kd && kd < 2.0 / dt)) return;
  throw std::invalid_argument("effort.kd: is " + std::to_string(kd) + " for joint '" + joint + "': must be above " +
                              std::to_string(least) + " = kp dt/2 and below " + std::to_string(2.0 / dt) +
                              " = 2/dt: give other gains, or a higher update_rate");
}

/// A payload of the mass as a link whose frame is the tip.
[[nodiscard]] fpbm::LinkInertia<> payload_of(const target_controller::Params& params, double mass) {
  require(std::isfinite(mass), "effort.payload.mass: is " + std::to_string(mass) + ": must be finite");
  require(mass == 0.0 || params.tasks.empty(),
          "effort.payload: is at tip_frame, but tasks are given: add the payload to robot_description");
  fpbm::LinkInertia<> load;
  load.mass = mass;
  load.centre = three("effort.payload.centre", params.effort.payload.centre);
  return load;
}

}  // namespace

ComputedTorque::Model TargetController::dynamics(const fpbm::Tree<>& tree, double mass) const {
  ComputedTorque::Model model(tree, three("effort.gravity", params_.effort.gravity));
  const auto& tip = tree.frames.at(0);
  (void)model.set_payload(tip.link, payload_of(params_, mass), tip.offset);
  return model;
}

TargetController::Joints TargetController::efforts() const {
  const Joints& effort = limits_->bounds().effort;
  for (Eigen::Index i = 0; i < effort.size(); ++i) {
    require(std::isfinite(effort(i)),
            "limits.effort: joint '" + params_.joints[static_cast<std::size_t>(i)] +
                "' has no bound on its torque, because its effort in robot_description is missing or 0: give "
                "limits.effort");
  }
  return effort;
}

ComputedTorque TargetController::computed_torque(const fpbm::Tree<>& tree) const {
  const auto& given = params_.effort;
  const Eigen::Index dof = robot_->dof();
  ComputedTorque::Settings settings{Joints::Zero(dof), Joints::Zero(dof), efforts(), given.robot_adds_gravity};
  require(!given.kp.empty() || !given.kd.empty() || has_positions(),
          "effort.kp: is empty: give a gain for each joint, or zeros for torques without feedback");
  if (!given.kp.empty()) settings.kp = joint_numbers("effort.kp", given.kp);
  settings.kd = given.kd.empty() ? Joints(2.0 * settings.kp.cwiseSqrt()) : joint_numbers("effort.kd", given.kd);
  for (Eigen::Index i = 0; i < dof; ++i) {
    require_stable(params_.joints[static_cast<std::size_t>(i)], settings.kp(i), settings.kd(i), dt_);
  }
  const ComputedTorque torque(dynamics(tree, given.payload.mass), settings);
  require(!torque.has_feedback() || params_.state_interfaces.size() == 2,
          "state_interfaces: has no velocity, which the gains of effort need: give [position, velocity]");
  return torque;
}

std::shared_ptr<TorqueBounds> TargetController::torque_bounds(const fpbm::Tree<>& tree) const {
  const double mass = params_.effort.payload.mass;
  const double uncertainty = params_.torque_bounds.payload.uncertainty;
  std::optional<ComputedTorque::Model> lighter;
  if (uncertainty > 0.0) lighter = dynamics(tree, std::max(mass - uncertainty, 0.0));
  return std::make_shared<TorqueBounds>(tree, dynamics(tree, mass + uncertainty),
                                        Joints(params_.torque_bounds.fraction * efforts()), lighter);
}

}  // namespace fpbm_controllers
