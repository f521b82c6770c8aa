#include <exception>
#include <limits>

#include "check.hpp"
#include "tests.hpp"

namespace {

using rclcpp::ParameterValue;
using stand_in::Robot;

void given(const char* what, const Robot::Overrides& overrides, bool valid, const char* named) {
  Robot robot;
  (void)logged("");
  try {
    const bool loaded = robot.load(overrides);
    check(loaded == valid, what, loaded);
    check(logged(named), (std::string(what) + ": named").c_str(), 1);
  } catch (const std::exception& error) {
    check(false, (std::string(what) + ": throws " + error.what()).c_str(), 0);
  }
}

}  // namespace

void parameters() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  given("tip_rate: 50", {{"tip_rate", ParameterValue(50)}}, true, "");
  const std::vector<std::int64_t> twos(7, 2);
  given("limits.acceleration of integers", {{"limits.acceleration", ParameterValue(twos)}}, true, "");
  given("tip_rate: .nan", {{"tip_rate", ParameterValue(nan)}}, false, "tip_rate");
  given("diagnostics_rate: .nan", {{"diagnostics_rate", ParameterValue(nan)}}, false, "diagnostics_rate");
  given("target.timeout: .inf", {{"target.timeout", ParameterValue(std::numeric_limits<double>::infinity())}}, false,
        "timeout");
  given("target.velocty: 0.1", {{"target.velocty", ParameterValue(0.1)}}, false, "target.velocty");
  given("target.velocty: 1", {{"target.velocty", ParameterValue(1)}}, false, "target.velocty");
  given("target_velocity: 0.1", {{"target_velocity", ParameterValue(0.1)}}, false, "give target.velocity");
  given("Tip_Frame: hand", {{"Tip_Frame", ParameterValue(std::string("hand"))}}, false, "give tip_frame");
  given("limits.position: 1", {{"limits.position", ParameterValue(1)}}, false, "limits.position");
  // The manager forwards its parameter file to all controllers, with the parameters under /**.
  const std::string text = "<robot name='panda'/>";
  given("robot_description under /**", {{"robot_description", ParameterValue(text)}}, true, "robot_description");
  given("parameters of other nodes under /**",
        {{"robot_ip", ParameterValue(std::string("172.16.0.2"))},
         {"hardware.timeout", ParameterValue(1)},
         {"arm_id", ParameterValue(std::string("fr3"))}},
        true, "arm_id, hardware.timeout, robot_ip");
  given("tip_rate: fast", {{"tip_rate", ParameterValue(std::string("fast"))}}, false, "tip_rate");
  given("use_sim_time: true, type: ...",
        {{"use_sim_time", ParameterValue(true)},
         {"type", ParameterValue(std::string("fpbm_controllers/TargetController"))}},
        true, "");
}
