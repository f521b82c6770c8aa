#include <fpbm_moveit/kinematics_plugin.hpp>
#include <pluginlib/class_list_macros.hpp>

PLUGINLIB_EXPORT_CLASS(fpbm_moveit::KinematicsPlugin, kinematics::KinematicsBase)
