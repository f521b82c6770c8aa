#include <algorithm>
#include <fpbm/bound/preset_capsules.hpp>
#include <stdexcept>

#include "fpbm_controllers/description.hpp"
#include "fpbm_controllers/urdf_model.hpp"

namespace fpbm_controllers {

namespace {

constexpr const char* kRemedy = ": give clearance.links and clearance.capsules, which fpbm-cpp export-capsules writes";

[[nodiscard]] const fpbm::presets::PresetCapsules& capsules_of(const std::string& name) {
  for (const auto& preset : fpbm::presets::kAllCapsules) {
    if (name == preset.name) return preset;
  }
  throw std::invalid_argument("clearance.capsules: is empty, and " +
                              (name.empty() ? "arm has no preset" : "preset '" + name + "' has no capsules") + kRemedy);
}

[[nodiscard]] bool are_equal(const fpbm::Transform<>& a, const fpbm::Transform<>& b) {
  constexpr double kTolerance = 2e-3;  // [m, rad]. The margin must be larger. The capsules are rounded to 1e-4 m.
  return (a.p - b.p).norm() < kTolerance && (a.R - b.R).norm() < kTolerance;
}

[[nodiscard]] std::string child_of(const urdf::Model& model, const std::string& joint) {
  const auto found = std::find_if(model.links_.begin(), model.links_.end(), [&joint](const auto& each) {
    return each.second->parent_joint && each.second->parent_joint->name == joint;
  });
  return found == model.links_.end() ? joint : found->first;
}

}  // namespace

NamedCapsules preset_capsules(const fpbm::Tree<>& tree, const std::string& robot_description, const std::string& base,
                              const std::string& name) {
  const auto& preset = capsules_of(name);
  const fpbm::Chain<> known = preset_chain(name);
  const urdf::Model model = model_of(robot_description);
  NamedCapsules result;
  for (int end = 1; end <= static_cast<int>(tree.joints.size()); ++end) {
    if (!is_end(tree, end)) continue;
    const std::vector<std::size_t> joints = joints_to(tree, end);
    if (joints.size() != known.joints.size()) {
      throw std::invalid_argument("clearance.capsules: is empty, and an arm has not the joints of preset '" + name +
                                  "'" + kRemedy);
    }
    std::vector<std::string> names{base};
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const auto& joint = tree.joints[joints[k]].joint;
      names.push_back(child_of(model, joint.name));
      const bool is_turned = (fpbm::normalized(joint.axis) - fpbm::normalized(known.joints[k].axis)).norm() > 1e-3;
      if (is_turned || (k > 0 && !are_equal(joint.placement, known.joints[k].placement))) {
        throw std::invalid_argument("clearance.capsules: is empty, and the frame of joint '" + joint.name +
                                    "' is not the frame in preset '" + name + "'" + kRemedy);
      }
    }
    const fpbm::Transform<> base_of_arm = tree.joints[joints[0]].joint.placement * inverse(known.joints[0].placement);
    const auto name_of = [&](const std::string& own) {
      const std::vector<fpbm::LinkCapsule<>> all = preset.capsules();
      const auto found = std::find_if(all.begin(), all.end(), [&own](const auto& each) { return each.name == own; });
      return names.at(static_cast<std::size_t>(found->link));
    };
    for (fpbm::LinkCapsule<> each : preset.capsules()) {
      each.name = names.at(static_cast<std::size_t>(each.link));
      if (each.link == 0) {
        each.capsule = fpbm::placed(each.capsule, base_of_arm);
      } else {
        each.link = static_cast<int>(joints[static_cast<std::size_t>(each.link - 1)]) + 1;
      }
      result.capsules.push_back(each);
    }
    for (const auto& [a, b] : preset.never_collide()) result.never_collide.emplace_back(name_of(a), name_of(b));
  }
  return result;
}

}  // namespace fpbm_controllers
