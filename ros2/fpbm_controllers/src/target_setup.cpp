#include <stdexcept>

#include "fpbm_controllers/target_controller.hpp"

namespace fpbm_controllers {

namespace {

[[nodiscard]] fpbm::Chain<> preset(const std::string& name) {
  for (const auto& arm : fpbm::presets::kAll) {
    if (name == arm.name) return arm.chain();
  }
  throw std::invalid_argument("arm: there is no " + name);
}

/// Roll, pitch and yaw about the fixed axes x, y and z, as in a URDF.
[[nodiscard]] fpbm::Transform<> transform(const std::vector<double>& xyz, const std::vector<double>& rpy) {
  using Vector = fpbm::Vector<3>;
  fpbm::Transform<> result;
  result.p = {xyz.at(0), xyz.at(1), xyz.at(2)};
  result.R = fpbm::rotation(Vector(0.0, 0.0, rpy.at(2))) * fpbm::rotation(Vector(0.0, rpy.at(1), 0.0)) *
             fpbm::rotation(Vector(rpy.at(0), 0.0, 0.0));
  return result;
}

[[nodiscard]] fpbm::Vector<Eigen::Dynamic> vector_of(const char* name, const std::vector<double>& values,
                                                     Eigen::Index dof) {
  if (values.size() != static_cast<std::size_t>(dof)) {
    throw std::invalid_argument(std::string(name) + ": must be " + std::to_string(dof) + " numbers");
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), dof);
}

}  // namespace

void TargetController::read_parameters() {
  params_ = listener_->get_params();
  fpbm::Chain<> chain = preset(params_.arm);
  chain.tip = chain.tip * transform(params_.tool.xyz, params_.tool.rpy);
  arm_.emplace(chain);

  const Eigen::Index dof = arm_->dof();
  if (params_.joints.size() != static_cast<std::size_t>(dof)) {
    throw std::invalid_argument("joints: " + params_.arm + " has " + std::to_string(dof) + " of them");
  }
  if (params_.command_interfaces.empty() || params_.command_interfaces[0] != "position") {
    throw std::invalid_argument("command_interfaces: the first must be position");
  }
  options_.dt = 1.0 / static_cast<double>(get_update_rate());
  options_.null_damping = 0.0;  // scheme.null_damping alone decides.
  limits_.emplace(limits(), options_.dt);

  const auto& target = params_.target;
  fpbm::TargetFilterOptions<> filter;
  filter.dt = options_.dt;
  filter.timeout = target.timeout;
  const fpbm::TargetBounds<> bounds{target.velocity,         target.acceleration,         target.jerk,
                                    target.angular_velocity, target.angular_acceleration, target.angular_jerk};
  filter_.emplace(fpbm::Transform<>{}, bounds, filter);
  fpbm::require_stable(scheme(Joints::Zero(dof)), fpbm::TickOfGains<>{options_.dt, options_.integral_gain});
}

TargetController::JointLimits TargetController::limits() const {
  JointLimits result = arm_->limits();
  const auto& given = params_.limits;
  const auto take = [&](const char* name, const std::vector<double>& values, Joints& bound) {
    if (!values.empty()) bound = vector_of(name, values, arm_->dof());
  };
  take("limits.lower", given.lower, result.lower);
  take("limits.upper", given.upper, result.upper);
  take("limits.velocity", given.velocity, result.velocity);
  take("limits.acceleration", given.acceleration, result.acceleration);
  take("limits.jerk", given.jerk, result.jerk);
  return result;
}

TargetController::Scheme TargetController::scheme(const Joints& start) const {
  const auto& given = params_.scheme;
  auto null_space = fpbm::NullSpace<kDof>().with_damping(given.null_damping);
  if (given.rest_stiffness > 0.0) {
    const Joints rest =
        given.rest_posture.empty() ? start : vector_of("scheme.rest_posture", given.rest_posture, arm_->dof());
    null_space = null_space.with_rest_posture(rest, given.rest_stiffness);
  }
  const Joints weights = given.weights.empty() ? Joints(Joints::Ones(start.size()))
                                               : vector_of("scheme.weights", given.weights, arm_->dof());
  return fpbm::FPBM<kDof>(given.alpha, weights, given.k1, given.k2, null_space);
}

}  // namespace fpbm_controllers
