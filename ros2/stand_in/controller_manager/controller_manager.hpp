#pragma once

#include <atomic>
#include <chrono>
#include <controller_interface/controller_interface.hpp>
#include <description.hpp>
#include <fpbm/model/presets.hpp>
#include <fpbm_controllers/target_controller_parameters.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>
#include <yaml.hpp>

// Stands in for ros2_control's header of this name, and for the headers of rclcpp that it includes: a manager of one
// controller on mock hardware of a Panda. As in ros2_control, switching and unloading wait for the loop: switching for
// a tick, and unloading, after the first tick, for a tick that does not use the controller.
namespace rclcpp {

inline void init(int, const char* const*) {}
inline void shutdown() {}
class Executor {};
namespace executors {

class SingleThreadedExecutor : public Executor {};

}  // namespace executors

}  // namespace rclcpp

namespace controller_manager {

class ControllerManager {
 public:
  using Controller = controller_interface::ControllerInterface;
  using return_type = controller_interface::return_type;
  using Names = std::vector<std::string>;
  struct TextParameter {
    std::string name;
    std::string value;
  };

  /// Registers a Panda with the names of its manufacturer as the model of the description.
  ControllerManager(const std::shared_ptr<rclcpp::Executor>&, const std::string& urdf, bool, const std::string&)
      : urdf_(urdf) {
    stand_in::parameters = {};
    urdf::Model& model = stand_in::descriptions()[urdf] = {};
    model.links_["panda_link0"] = std::make_shared<urdf::Link>(urdf::Link{"panda_link0", nullptr});
    stand_in::add_chain(model, fpbm::presets::panda(), "panda_link0");
    stand_in::add(model, "panda_joint8", "flange", "panda_link8", {});
  }

  void set_parameter(const TextParameter& file) { file_ = file.value; }
  std::shared_ptr<Controller> load_controller(const std::string& name, const std::string&) {
    controller_ = stand_in::exported_plugin();
    const controller_interface::ControllerInterfaceParams params{name, urdf_, kRate, kRate};
    const bool good = controller_->init(params, ParameterFile::read(file_, name)) == return_type::OK;
    return good ? controller_ : nullptr;
  }
  return_type configure_controller(const std::string&) {
    return controller_->configure() == controller_interface::CallbackReturn::SUCCESS ? return_type::OK
                                                                                     : return_type::ERROR;
  }
  return_type switch_controller(const Names& activate, const Names&, int) {
    switch_to_ = activate.empty() ? 0 : 1;
    while (switch_to_ >= 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return active_ == !activate.empty() ? return_type::OK : return_type::ERROR;
  }
  return_type unload_controller(const std::string&) {
    const int before = ticks_;
    while (before > 0 && ticks_ == before) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::lock_guard<std::mutex> lock(mutex_);
    controller_.reset();
    return return_type::OK;
  }

  [[nodiscard]] rclcpp::Time now() const { return rclcpp::Time(); }
  void read(const rclcpp::Time&, const rclcpp::Duration&) {}
  void write(const rclcpp::Time&, const rclcpp::Duration&) { q_ = command_; }
  return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++ticks_;
    if (switch_to_ == 1) {
      std::vector<hardware_interface::LoanedCommandInterface> commands;
      std::vector<hardware_interface::LoanedStateInterface> states;
      for (std::size_t i = 0; i < q_.size(); ++i) {
        commands.emplace_back(command_[i], lock_);
        states.emplace_back(q_[i], lock_);
      }
      controller_->assign_interfaces(std::move(commands), std::move(states));
      active_ = controller_->on_activate({}) == controller_interface::CallbackReturn::SUCCESS;
    } else if (switch_to_ == 0) {
      (void)controller_->on_deactivate({});
      controller_->release_interfaces();
      active_ = false;
    }
    switch_to_ = -1;
    return active_ ? controller_->update(time, period) : return_type::OK;
  }

 private:
  static constexpr unsigned int kRate = 100;  ///< [Hz]

  std::string urdf_;
  std::string file_;
  std::mutex mutex_;  ///< Protects the controller.
  std::shared_ptr<Controller> controller_;
  std::atomic<int> ticks_{0};
  std::atomic<int> switch_to_{-1};  ///< 1: activate in the next tick, 0: deactivate, -1: neither.
  std::atomic<bool> active_{false};
  std::vector<double> q_{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  std::vector<double> command_ = q_;
  stand_in::Lock lock_;
};

}  // namespace controller_manager
