#pragma once

#include <cstddef>
#include <fpbm/bound/detail/link_capsule.hpp>
#include <fpbm/model/chain.hpp>
#include <fpbm/model/tree.hpp>
#include <string>
#include <utility>
#include <vector>

namespace fpbm_controllers {

/// A link of a robot_description, and the parameter that names it.
struct NamedLink {
  std::string parameter;
  std::string link;
};

/// The joints of a robot_description (URDF) from link base to each of `links`, with their bounds on position and
/// velocity, and a frame for each of `links`. The order is: the joints from base to the first link, the further joints
/// to the second link, and so on.
/// Throws std::invalid_argument, which names the parameter, if the text or a link is missing, if link base moves with a
/// joint that is not between base and a link, or if fpbm::Tree does not have the type of a joint.
[[nodiscard]] fpbm::Tree<> tree_of(const std::string& robot_description, const std::string& base,
                                   const std::vector<NamedLink>& links);

/// Adds the inertias of the links, and the friction of the drives, from a robot_description. A link that is fixed to a
/// link of the tree, or moves relative to this link with joints that are not in the tree, is added to this link, with
/// those joints at position zero. Throws std::invalid_argument, which names the link, if a joint moves no mass.
void add_inertias(fpbm::Tree<>& tree, const std::string& robot_description, const std::string& base);

/// The joints of a tree from its base to a link.
[[nodiscard]] std::vector<std::size_t> joints_to(const fpbm::Tree<>& tree, int link);

/// The joints of joints_to() as a chain with the link as tip. A mimic joint keeps the number of the leader in the tree.
[[nodiscard]] fpbm::Chain<> chain_to(const fpbm::Tree<>& tree, int link);

/// Whether a link is the end of an arm, because the link carries no joint of the tree.
[[nodiscard]] bool is_end(const fpbm::Tree<>& tree, int link);

/// The arm of a preset. Throws std::invalid_argument if the preset does not exist.
[[nodiscard]] fpbm::Chain<> preset_chain(const std::string& name);

/// The capsules of a preset on each arm of a tree, with the names of the links of robot_description, and the pairs of
/// names that never collide. Throws std::invalid_argument if the preset has no capsules, or the joint frames of an arm
/// differ from the frames of the preset.
struct NamedCapsules {
  std::vector<fpbm::LinkCapsule<>> capsules;
  std::vector<std::pair<std::string, std::string>> never_collide;
};
[[nodiscard]] NamedCapsules preset_capsules(const fpbm::Tree<>& tree, const std::string& robot_description,
                                            const std::string& base, const std::string& name);

/// Throws std::invalid_argument, which names the joint and the difference, if a preset is not the described arm:
/// axes differ by more than 0.02 m or 0.05 rad from each other, or a described range or velocity exceeds the preset's
/// by more than 1 %. Bases, tips and narrower bounds may differ. tip: the link at the arm's end, for messages.
void require_match(const fpbm::Chain<>& described, const std::string& tip, const std::string& name,
                   const fpbm::Chain<>& preset);

}  // namespace fpbm_controllers
