// Loads, configures, activates and deactivates the controller in a real controller manager, on mock hardware.

#include <gtest/gtest.h>

#include <chrono>
#include <controller_manager/controller_manager.hpp>
#include <controller_manager_msgs/srv/switch_controller.hpp>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace {

using controller_interface::return_type;
using controller_manager::ControllerManager;

/// urdf/panda.urdf.xacro without visual elements.
std::string description() {
  struct Joint {
    const char* xyz;
    const char* tilt;
    const char* range;
    const char* velocity;
    const char* start;
  };
  const Joint joints[] = {{"0 0 0.333", "0", "lower='-2.8973' upper='2.8973'", "2.175", "0.0"},
                          {"0 0 0", "-1.5707963267948966", "lower='-1.7628' upper='1.7628'", "2.175", "-0.3"},
                          {"0 -0.316 0", "1.5707963267948966", "lower='-2.8973' upper='2.8973'", "2.175", "0.0"},
                          {"0.0825 0 0", "1.5707963267948966", "lower='-3.0718' upper='-0.0698'", "2.175", "-2.2"},
                          {"-0.0825 0.384 0", "-1.5707963267948966", "lower='-2.8973' upper='2.8973'", "2.61", "0.0"},
                          {"0 0 0", "1.5707963267948966", "lower='-0.0175' upper='3.7525'", "2.61", "2.0"},
                          {"0.088 0 0", "1.5707963267948966", "lower='-2.8973' upper='2.8973'", "2.61", "0.785"}};
  std::ostringstream links;
  std::ostringstream drives;
  links << "<link name='panda_link0'/>";
  int number = 0;
  for (const auto& [xyz, tilt, range, velocity, start] : joints) {
    const int before = number++;
    links << "<link name='panda_link" << number << "'/><joint name='panda_joint" << number
          << "' type='revolute'><parent link='panda_link" << before << "'/><child link='panda_link" << number
          << "'/><origin xyz='" << xyz << "' rpy='" << tilt << " 0 0'/><axis xyz='0 0 1'/><limit " << range
          << " velocity='" << velocity << "' effort='80'/></joint>";
    drives << "<joint name='panda_joint" << number << "'><command_interface name='position'/>"
           << "<state_interface name='position'><param name='initial_value'>" << start
           << "</param></state_interface></joint>";
  }
  return "<?xml version='1.0'?><robot name='panda'>" + links.str() +
         "<link name='panda_link8'/><joint name='panda_joint8' type='fixed'><parent link='panda_link7'/>"
         "<child link='panda_link8'/><origin xyz='0 0 0.107'/></joint>"
         "<ros2_control name='panda' "
         "type='system'><hardware><plugin>mock_components/GenericSystem</plugin></hardware>" +
         drives.str() + "</ros2_control></robot>";
}

class TargetController : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }

  [[nodiscard]] bool load(const std::string& parameters) {
    manager_.set_parameter({"targets.params_file", std::string(TEST_FOLDER) + "/" + parameters});
    return manager_.load_controller("targets", "fpbm_controllers/TargetController") != nullptr;
  }
  /// Result of a function of the manager that waits for its loop, which is called meanwhile. If there is no result
  /// within 2,000 ticks, the process ends, because a waiting function cannot be cancelled.
  template <typename Function>
  return_type in_loop(const Function& function) {
    auto done = std::async(std::launch::async, function);
    for (int ticks = 0; done.wait_for(std::chrono::milliseconds(10)) != std::future_status::ready; ++ticks) {
      if (ticks == 2000) {
        std::fprintf(stderr, "the controller manager still waits after %d ticks\n", ticks);
        std::abort();
      }
      tick();
    }
    return done.get();
  }
  return_type change(const std::vector<std::string>& activate, const std::vector<std::string>& deactivate) {
    return in_loop([&] {
      return manager_.switch_controller(activate, deactivate,
                                        controller_manager_msgs::srv::SwitchController::Request::STRICT);
    });
  }
  void tick() {
    const rclcpp::Duration period(0, 10000000);
    manager_.read(manager_.now(), period);
    EXPECT_EQ(manager_.update(manager_.now(), period), return_type::OK);
    manager_.write(manager_.now(), period);
  }

  std::shared_ptr<rclcpp::Executor> executor_ = std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
  ControllerManager manager_{executor_, description(), true, "test_controller_manager"};
};

TEST_F(TargetController, is_activated_and_deactivated_again_and_again) {
  ASSERT_TRUE(load("panda.yaml"));
  ASSERT_EQ(manager_.configure_controller("targets"), return_type::OK);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(change({"targets"}, {}), return_type::OK);
    for (int k = 0; k < 20; ++k) tick();
    ASSERT_EQ(change({}, {"targets"}), return_type::OK);
  }
  EXPECT_EQ(in_loop([&] { return manager_.unload_controller("targets"); }), return_type::OK);
}

TEST_F(TargetController, is_not_configured_as_another_arm) {
  ASSERT_TRUE(load("fr3.yaml"));
  EXPECT_EQ(manager_.configure_controller("targets"), return_type::ERROR);
}

}  // namespace
