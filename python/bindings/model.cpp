#include "arm.hpp"
#include "fpbm/any/make_arm.hpp"

namespace fpbm::bindings {

std::pair<int, Transform<>> Model::frame(const std::string& name) const {
  constexpr std::size_t kShown = 12;
  std::string known;
  std::size_t count = 0;
  const auto list = [&](const std::string& other) {
    if (++count <= kShown) known += ", '" + other + "'";
  };
  for (const auto& [other, link, offset] : tree.frames) {
    if (other == name) return {link, offset};
    list(other);
  }
  for (std::size_t i = 0; i < tree.joints.size(); ++i) {
    const std::string& joint = tree.joints[i].joint.name;
    if (joint == name) return {static_cast<int>(i) + 1, {}};
    list(joint);
  }
  if (name == "base") return {0, {}};  // Unless a frame has that name, as in UR's URDF files.
  if (count > kShown) known += " and " + std::to_string(count - kShown) + " more";
  validation::reject("frame", " = '" + name + "': must be a frame, or the joint of a link: 'base'" + known);
}

namespace {

/// An arm in the plane: joints about z at each link's start, with the links along x.
Chain<> chain_of(const JointVector& lengths) {
  Chain<> chain;
  for (const double length : lengths) {
    Joint<> joint;
    joint.placement = chain.tip;
    joint.name = "joint_" + std::to_string(chain.joints.size() + 1);
    chain.joints.push_back(joint);
    chain.tip.p = {length, 0.0, 0.0};
  }
  return chain;
}

}  // namespace

Arm::Arm(const JointVector& lengths) : Arm(make_planar_arm(lengths), lengths, chain_of(lengths), true) {}
Arm::Arm(const Chain<>& chain) : Arm(make_arm(chain), chain, chain, false) {}

}  // namespace fpbm::bindings
