#pragma once

#include <controller_interface/controller_interface.hpp>
#include <memory>
#include <string>
#include <vector>

// Stands in for the header that generate_parameter_library makes of target_controller_parameters.yaml. The test sets
// what the listener reads.
namespace target_controller {

struct Params {
  std::vector<std::string> joints;
  std::string arm;
  std::string base_frame;
  struct Tool {
    std::vector<double> xyz = {0.0, 0.0, 0.0};
    std::vector<double> rpy = {0.0, 0.0, 0.0};
  } tool;
  struct Limits {
    std::vector<double> lower = {};
    std::vector<double> upper = {};
    std::vector<double> velocity = {};
    std::vector<double> acceleration = {};
    std::vector<double> jerk = {};
  } limits;
  std::vector<std::string> command_interfaces = {"position"};
  double following_error = 0.05;
  double tip_rate = 50.0;
  double diagnostics_rate = 1.0;
  struct Scheme {
    double alpha = 0.6;
    std::vector<double> weights = {};
    double k1 = 20.0;
    double k2 = 100.0;
    double null_damping = 4.0;
    double rest_stiffness = 4.0;
    std::vector<double> rest_posture = {};
  } scheme;
  struct Target {
    double velocity = 0.5;
    double acceleration = 1.5;
    double jerk = 30.0;
    double angular_velocity = 1.0;
    double angular_acceleration = 3.0;
    double angular_jerk = 60.0;
    double timeout = 0.2;
  } target;
};

}  // namespace target_controller

namespace stand_in {

inline target_controller::Params parameters;

}  // namespace stand_in

namespace target_controller {

class ParamListener {
 public:
  template <typename NodeT>
  explicit ParamListener(NodeT, const std::string& = "") {}
  [[nodiscard]] Params get_params() const { return stand_in::parameters; }
};

}  // namespace target_controller
