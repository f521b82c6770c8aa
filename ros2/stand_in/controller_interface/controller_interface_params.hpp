#pragma once

#include <string>

// Stands in for ros2_control's header of this name. The manager gives limits only if the manager enforces limits, which
// is not the default of Jazzy.
namespace controller_interface {

struct ControllerInterfaceParams {
  std::string controller_name;
  std::string robot_description;
  unsigned int update_rate = 0;
  unsigned int controller_manager_update_rate = 0;
};

}  // namespace controller_interface
