#pragma once

#include <cmath>
#include <description.hpp>
#include <driven.hpp>
#include <fpbm/model/presets.hpp>
#include <fpbm/model/serial_arm.hpp>
#include <memory>
#include <string>

namespace stand_in {

/// Two Pandas at a table, 0.8 m apart along y. Link "table" carries "left_base" and "right_base"; the ends of the arms
/// are "left_flange" and "right_flange".
class TwoArms : public Driven<14> {
 public:
  TwoArms() : Driven("two_pandas", limits(), start()) {
    urdf::Model& model = descriptions()["two_pandas"] = {};
    model.links_["table"] = std::make_shared<urdf::Link>(urdf::Link{"table", nullptr});
    for (const std::string side : {"left", "right"}) {
      const std::string base = side + "_base";
      add(model, "to_" + base, "table", base, base_of(side));
      add_chain(model, fpbm::presets::panda(), base, side + "_");
    }
    auto& own = parameters;
    for (const std::string side : {"left_", "right_"}) {
      for (const auto& joint : fpbm::presets::panda().joints) own.joints.push_back(side + joint.name);
    }
    own.arm = "panda";
    own.base_frame = "table";
    own.command_interfaces = {"position", "velocity"};
  }

  /// Pose of the flange of an arm, "left" or "right", in the frame of the table, at the commanded positions.
  [[nodiscard]] fpbm::Transform<> tip(const std::string& side) const {
    fpbm::Kinematics<fpbm::Pose, 7> kinematics;
    const Joints& posture = std::isnan(command[0]) ? q : command;
    arm_.kinematics(fpbm::Vector<7>(posture.data() + (side == "left" ? 0 : 7)), kinematics);
    return base_of(side) * kinematics.tip;
  }
  /// Pose of the left flange in the frame of the right flange.
  [[nodiscard]] fpbm::Transform<> grasp() const { return inverse(tip("right")) * tip("left"); }

 private:
  [[nodiscard]] static fpbm::Transform<> base_of(const std::string& side) {
    fpbm::Transform<> base;
    base.p(1) = side == "left" ? 0.4 : -0.4;
    return base;
  }
  [[nodiscard]] static Joints start() {
    return {0.1, -0.6, 0.0, -2.4, 0.1, 1.8, 0.6, -0.1, -0.5, 0.1, -2.3, 0.0, 1.9, 0.9};
  }
  [[nodiscard]] static JointLimits limits() {
    const fpbm::JointLimits<7> one = fpbm::SerialArm<7>(fpbm::presets::panda()).limits();
    JointLimits both = JointLimits::none(14);
    for (Eigen::Index i = 0; i < 14; ++i) both.set(i, one.joint(i % 7));
    return both;
  }

  fpbm::SerialArm<7> arm_{fpbm::presets::panda()};
};

}  // namespace stand_in
