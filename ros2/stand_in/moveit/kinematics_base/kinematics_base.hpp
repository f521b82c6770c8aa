#pragma once

#include <functional>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <memory>
#include <moveit/robot_model/robot_model.hpp>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

// Stands in for MoveIt's header of the base class of kinematics plugins, and for the messages and functions of rclcpp
// that this header includes: the virtual functions that the plugin overrides, with the types of MoveIt.
namespace rclcpp {

class Node {
 public:
  using SharedPtr = std::shared_ptr<Node>;
};
inline Logger get_logger(const std::string&) {
  return {};
}

}  // namespace rclcpp

namespace moveit_msgs::msg {

struct MoveItErrorCodes {
  static constexpr int SUCCESS = 1;
  static constexpr int TIMED_OUT = -6;
  static constexpr int GOAL_IN_COLLISION = -12;
  static constexpr int NO_IK_SOLUTION = -31;
  int val = 0;
};

}  // namespace moveit_msgs::msg

namespace kinematics {

struct KinematicsQueryOptions {
  bool lock_redundant_joints = false;
  bool return_approximate_solution = false;
};

class KinematicsBase {
 public:
  using Pose = geometry_msgs::msg::Pose;
  using Numbers = std::vector<double>;
  using Codes = moveit_msgs::msg::MoveItErrorCodes;
  using Options = KinematicsQueryOptions;
  using IKCallbackFn = std::function<void(const Pose&, const Numbers&, Codes&)>;

  virtual ~KinematicsBase() = default;
  virtual bool initialize(const rclcpp::Node::SharedPtr& node, const moveit::core::RobotModel& robot_model,
                          const std::string& group_name, const std::string& base_frame,
                          const std::vector<std::string>& tip_frames, double search_discretization) = 0;
  virtual bool getPositionIK(const Pose& ik_pose, const Numbers& ik_seed_state, Numbers& solution, Codes& error_code,
                             const Options& options = Options()) const = 0;
  virtual bool searchPositionIK(const Pose& ik_pose, const Numbers& ik_seed_state, double timeout, Numbers& solution,
                                Codes& error_code, const Options& options = Options()) const = 0;
  virtual bool searchPositionIK(const Pose& ik_pose, const Numbers& ik_seed_state, double timeout,
                                const Numbers& consistency_limits, Numbers& solution, Codes& error_code,
                                const Options& options = Options()) const = 0;
  virtual bool searchPositionIK(const Pose& ik_pose, const Numbers& ik_seed_state, double timeout, Numbers& solution,
                                const IKCallbackFn& solution_callback, Codes& error_code,
                                const Options& options = Options()) const = 0;
  virtual bool searchPositionIK(const Pose& ik_pose, const Numbers& ik_seed_state, double timeout,
                                const Numbers& consistency_limits, Numbers& solution,
                                const IKCallbackFn& solution_callback, Codes& error_code,
                                const Options& options = Options()) const = 0;
  virtual bool getPositionFK(const std::vector<std::string>& link_names, const Numbers& joint_angles,
                             std::vector<Pose>& poses) const = 0;
  [[nodiscard]] virtual const std::vector<std::string>& getJointNames() const = 0;
  [[nodiscard]] virtual const std::vector<std::string>& getLinkNames() const = 0;
  [[nodiscard]] virtual const std::string& getTipFrame() const { return tip_frames_[0]; }

 protected:
  void storeValues(const moveit::core::RobotModel&, const std::string& group_name, const std::string& base_frame,
                   const std::vector<std::string>& tip_frames, double) {
    group_name_ = group_name;
    base_frame_ = base_frame;
    tip_frames_ = tip_frames;
  }

  rclcpp::Node::SharedPtr node_;
  std::string group_name_;
  std::string base_frame_;
  std::vector<std::string> tip_frames_;
};

}  // namespace kinematics

namespace stand_in {

std::unique_ptr<kinematics::KinematicsBase> exported_plugin();

}  // namespace stand_in
