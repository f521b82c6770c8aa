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

Arm::Arm(const JointVector& lengths, const Chain<>& chain, const Vector<3>& gravity_)
    : Arm(make_planar_arm(lengths), lengths, chain, gravity_, true) {}
Arm::Arm(const Chain<>& chain, const Vector<3>& gravity_) : Arm(make_arm(chain), chain, chain, gravity_, false) {}

}  // namespace fpbm::bindings
