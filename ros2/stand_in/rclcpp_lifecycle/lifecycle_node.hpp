#pragma once

// Stands in for rclcpp_lifecycle's header of this name, which ros2_control's header includes.
#include <controller_interface/controller_interface.hpp>
