#pragma once

// Stands in for the header that ROS generates from controller_manager_msgs/SwitchController.
namespace controller_manager_msgs::srv {

struct SwitchController {
  struct Request {
    static constexpr int STRICT = 2;
  };
};

}  // namespace controller_manager_msgs::srv
