#include <algorithm>
#include <fpbm/model/dynamics.hpp>
#include <memory>
#include <stdexcept>

#include "fpbm_controllers/description.hpp"
#include "fpbm_controllers/urdf_model.hpp"

namespace fpbm_controllers {

namespace {

using Inertia = fpbm::LinkInertia<>;

/// Inertia of a link, in the frame of the link.
[[nodiscard]] Inertia inertia_of(const urdf::Inertial& given) {
  Inertia at_centre;
  at_centre.mass = given.mass;
  at_centre.inertia << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz, given.iyz,
      given.izz;
  return fpbm::placed(transform_of(given.origin), at_centre);
}

/// The joint of the tree with a name, or none.
[[nodiscard]] fpbm::Joint<>* find(fpbm::Tree<>& tree, const urdf::Joint& named) {
  const auto found = std::find_if(tree.joints.begin(), tree.joints.end(),
                                  [&](const auto& each) { return each.joint.name == named.name; });
  return found == tree.joints.end() ? nullptr : &found->joint;
}

}  // namespace

void add_inertias(fpbm::Tree<>& tree, const std::string& robot_description, const std::string& base) {
  const urdf::Model model = model_of(robot_description);
  for (const auto& [name, link] : model.links_) {
    if (!link->inertial) continue;
    const auto [same, number, offset] = frame_of(tree, model, base, {"robot_description", name});
    if (number == 0) continue;
    fpbm::Joint<>& own = tree.joints[static_cast<std::size_t>(number - 1)].joint;
    own.moved = fpbm::joined(own.moved, fpbm::placed(offset, inertia_of(*link->inertial)));
  }
  for (const auto& [name, link] : model.links_) {
    fpbm::Joint<>* const own = link->parent_joint ? find(tree, *link->parent_joint) : nullptr;
    if (own == nullptr) continue;
    if (const auto& friction = link->parent_joint->dynamics) {
      own->drive.viscous = friction->damping;
      own->drive.dry = friction->friction;
    }
    if (!(own->moved.mass > 0.0)) {
      throw std::invalid_argument("robot_description: link '" + name +
                                  "' has no mass, which torques need: give its <inertial>");
    }
  }
}

}  // namespace fpbm_controllers
