#pragma once

#include <description.hpp>
#include <driven.hpp>
#include <fpbm/model/presets.hpp>
#include <fpbm/model/serial_arm.hpp>
#include <vector>

namespace stand_in {

/// A Panda with a tool, and limits narrower than the preset's.
class Robot : public Driven<7> {
 public:
  Robot() : Driven("panda", limits(), {0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785}) {
    descriptions()["panda"] = description_of(fpbm::presets::panda());
    auto& own = parameters;
    for (const auto& joint : fpbm::presets::panda().joints) own.joints.push_back(joint.name);
    own.arm = "panda";
    own.base_frame = "base";
    own.tip_frame = "flange";
    own.command_interfaces = {"position", "velocity"};
    own.limits.velocity = given(limits().velocity);
    own.limits.acceleration = given(limits().acceleration);
    own.limits.jerk = given(limits().jerk);
    own.tool.xyz = {0.02, 0.01, 0.1034};
    own.tool.rpy = {kRightAngle, 0.0, kRightAngle};
  }

  [[nodiscard]] fpbm::Transform<> tip() const {
    fpbm::Kinematics<fpbm::Pose, 7> kinematics;
    arm_.kinematics(fpbm::Vector<7>(q.data()), kinematics);
    return kinematics.tip;
  }

 private:
  static constexpr double kRightAngle = 1.5707963267948966;

  [[nodiscard]] static std::vector<double> given(const fpbm::Vector<7>& bound) { return {bound.begin(), bound.end()}; }
  /// The x, y and z axes of the tool are the y, z and x axes of the flange.
  [[nodiscard]] static fpbm::Chain<> chain() {
    fpbm::Chain<> panda = fpbm::presets::panda();
    fpbm::Transform<> tool;
    tool.p = {0.02, 0.01, 0.1034};
    tool.R << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
    panda.tip = panda.tip * tool;
    return panda;
  }
  [[nodiscard]] static JointLimits limits() {
    JointLimits limits = fpbm::SerialArm<7>(chain()).limits();
    limits.velocity *= 0.8;
    limits.acceleration *= 0.5;
    limits.jerk *= 0.25;
    return limits;
  }

  fpbm::SerialArm<7> arm_{chain()};
};

}  // namespace stand_in
