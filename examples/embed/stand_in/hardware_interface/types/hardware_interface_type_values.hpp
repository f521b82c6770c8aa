#pragma once

// Stands in for ros2_control's header of this name.
namespace hardware_interface {

inline constexpr char HW_IF_POSITION[] = "position";

}  // namespace hardware_interface
