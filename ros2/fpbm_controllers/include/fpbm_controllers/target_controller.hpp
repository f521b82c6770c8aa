#pragma once

#include <array>
#include <controller_interface/controller_interface.hpp>
#include <cstdint>
#include <fpbm/limits/limits.hpp>
#include <fpbm/model/robot.hpp>
#include <fpbm_controllers/computed_torque.hpp>
#include <fpbm_controllers/motion.hpp>
#include <fpbm_controllers/obstacles.hpp>
#include <fpbm_controllers/pace.hpp>
#include <fpbm_controllers/report.hpp>
#include <fpbm_controllers/sourced_limits.hpp>
#include <fpbm_controllers/target_controller_parameters.hpp>
#include <fpbm_controllers/target_topics.hpp>
#include <fpbm_controllers/task_settings.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fpbm_controllers {

/// Moves the tip, or the frames of several tasks, to target poses or at target twists, or the joints along a stream of
/// positions, and keeps the joint limits at every tick. The targets are messages that arrive at any rate.
///
/// A tick continues from the last command, never from the measured posture, which is only compared with the command.
/// With the command interface effort, the drives get the torques of the command (ComputedTorque).
class TargetController : public controller_interface::ControllerInterface {
 public:
  controller_interface::CallbackReturn on_init() override;
  [[nodiscard]] controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  [[nodiscard]] controller_interface::InterfaceConfiguration state_interface_configuration() const override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_shutdown(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_error(const rclcpp_lifecycle::State& previous) override;
  controller_interface::return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) override;

 private:
  static constexpr int kDof = Eigen::Dynamic;  // One instantiation serves robots of any number of joints.
  using Joints = fpbm::Vector<kDof>;
  using JointLimits = fpbm::JointLimits<kDof>;

  /// Throws std::invalid_argument if a parameter does not fit.
  void read_parameters();
  /// Throws std::invalid_argument if the controller manager does not call the controller once per tick of the update
  /// rate.
  void require_rate() const;
  /// The joints of robot_description, with the frames of each task: its frame and, if given, its reference frame. The
  /// frame of a single tip contains the tool.
  [[nodiscard]] fpbm::Tree<> described() const;
  /// Whether there is one task, in the base frame.
  [[nodiscard]] bool is_tip() const noexcept { return tasks_.size() == 1 && tasks_[0].reference.empty(); }
  /// The tasks with the frames of a tree from described().
  [[nodiscard]] std::vector<MotionTask> motion_tasks(const fpbm::Tree<>& tree) const;
  [[nodiscard]] MotionScheme scheme(Eigen::Index dof) const;
  /// The narrowest limits of the robot, ros2_control, the preset and the parameters; the limits are logged.
  [[nodiscard]] JointLimits limits(const fpbm::Tree<>& tree) const;
  /// Applies the limits of the ros2_control tags in robot_description.
  void narrow_by_tags(SourcedLimits& limits) const;
  /// Applies the soft limits (safety_controller) in robot_description.
  void narrow_softly(SourcedLimits& limits) const;
  /// The limits of the preset, for each arm of a tree. Throws std::invalid_argument if an arm is not the preset.
  [[nodiscard]] JointLimits preset_limits(const fpbm::Tree<>& tree) const;
  /// Sets the bounds and the torques of a tree from described().
  void make_bounds(const fpbm::Tree<>& tree);
  /// The dynamics of a tree with inertias, with a payload of the mass [kg] at the tip.
  [[nodiscard]] ComputedTorque::Model dynamics(const fpbm::Tree<>& tree, double mass) const;
  /// The efforts of all joints. Throws std::invalid_argument if a joint has no effort.
  [[nodiscard]] Joints efforts() const;
  /// The torques of a tree with inertias.
  [[nodiscard]] ComputedTorque computed_torque(const fpbm::Tree<>& tree) const;
  /// The bounds on the torques of a tree with inertias.
  [[nodiscard]] std::shared_ptr<TorqueBounds> torque_bounds(const fpbm::Tree<>& tree) const;
  /// The bounds on the positions of links.
  [[nodiscard]] std::shared_ptr<TaskBounds> task_bounds(const fpbm::Tree<>& tree) const;
  [[nodiscard]] ClearanceSettings clearance_settings(const fpbm::Tree<>& tree) const;
  /// A list of a parameter as a vector. Throws std::invalid_argument unless the list has a finite number for each
  /// joint.
  [[nodiscard]] Joints joint_numbers(const char* name, const std::vector<double>& values) const;
  /// Whether the commands contain positions, and not only torques.
  [[nodiscard]] bool has_positions() const noexcept { return params_.command_interfaces[0] == "position"; }
  void close();

  /// Throws std::runtime_error, which names the joint, if an interface cannot be read or the arm moves.
  [[nodiscard]] Joints start();

  /// Whether torques depend on the measured state.
  [[nodiscard]] bool has_feedback() const noexcept { return torque_ && torque_->has_feedback(); }
  void take_messages() noexcept;
  /// Counts a target with a stamp [s] that was pushed, and rejected or not.
  void count(std::size_t task, bool accepted, double stamp) noexcept;
  /// Advances the command by the time since the last call, by at most a tick: late calls delay the arm. A tick has the
  /// length for which the limits were made. A call before the end of a tick commands the state of its time in the tick.
  void advance(double period) noexcept;
  /// Starts from rest at the commanded positions. The motion to the newest poses continues. Returns false without
  /// effect if the commanded positions violate a bound.
  [[nodiscard]] bool restart();
  /// Reads the joints' positions, and for the feedback of torques the velocities. A joint that cannot be read keeps its
  /// last reading. Returns the number of the first joint that cannot be read.
  [[nodiscard]] std::optional<std::size_t> measure();
  /// Difference of two positions of joint i; for a continuous joint, difference of angles, because drivers wrap angles.
  [[nodiscard]] double difference(Eigen::Index i, double a, double b) const noexcept;
  /// Stops the arm if the following error of a joint is too large.
  void compare();
  void stop(Fault fault, std::size_t joint) noexcept;
  /// Sets the torques. commanded: at the time of the readings. A position or velocity without a reading has no
  /// feedback.
  void set_torques(const fpbm::State<kDof>& commanded, const Joints& acceleration) noexcept;
  /// Writes the command and the torques. Returns a joint whose command interface is locked.
  [[nodiscard]] std::optional<std::size_t> write(const Joints& torque);

  static constexpr int kLongestLock = 5;  ///< Ticks that the arm waits for a locked interface before it stops.

  unsigned int manager_rate_ = 0;  ///< [Hz]
  std::shared_ptr<target_controller::ParamListener> listener_;
  target_controller::Params params_;
  std::vector<TaskSettings> tasks_;
  std::optional<fpbm::Robot<kDof>> robot_;
  double dt_ = 0.0;  ///< Length of a tick [s].
  std::optional<fpbm::Limits<fpbm::Level::kAcceleration, kDof>> limits_;
  std::optional<Obstacles> obstacles_;  ///< From configuration until topics_ takes them.
  std::optional<TargetTopics> topics_;

  // Used only by the loop of an active controller.
  SharedBounds bounds_;
  std::unique_ptr<Motion> motion_;
  std::shared_ptr<JointChunk> chunk_;     ///< The newest joint positions.
  std::optional<ComputedTorque> torque_;  ///< None without the command interface effort.
  Pace pace_;
  Joints start_;  ///< Positions at activation.
  fpbm::State<kDof> tick_start_;
  fpbm::State<kDof> command_;                          ///< The last command.
  Joints accepted_;                                    ///< The last positions that the interfaces have accepted.
  std::array<std::uint64_t, Report::kTasks> seen_{};   ///< Target::count of each task's newest target.
  std::array<Target, Report::kTasks> newest_{};        ///< The newest target of each task that was not rejected.
  std::array<double, Report::kTasks> newest_stamp_{};  ///< Newest stamp of each task that was not rejected [s].
  int locked_for_ = 0;                                 ///< Ticks since all joints have taken a command.
  Joints measured_;
  Joints measured_velocity_;              ///< Zero without feedback of torques.
  fpbm::JointBits unread_positions_ = 0;  ///< Joints whose positions could not be read in this tick.
  fpbm::JointBits unread_velocities_ = 0;
  Report report_;
};

}  // namespace fpbm_controllers
