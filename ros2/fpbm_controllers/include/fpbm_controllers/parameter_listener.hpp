#pragma once

#include <fpbm_controllers/target_controller_parameters.hpp>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

namespace fpbm_controllers {

/// Declares the parameters. Integers are accepted for numbers. Throws if a value is invalid or missing, or the name of
/// a given parameter resembles the name of a parameter of the controller.
[[nodiscard]] std::shared_ptr<target_controller::ParamListener> listen_to_parameters(
    const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node);

}  // namespace fpbm_controllers
