#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "fpbm/model/chain.hpp"

namespace fpbm {

/// Mass of a link, and its centre in the frame of the link.
template <typename Scalar = double>
struct LinkMass {
  Scalar mass = 0;                                               ///< [kg]
  Vector<3, Scalar> centre = {Scalar(0), Scalar(0), Scalar(0)};  ///< [m]
};

/// Joint of a tree, and the link that carries the joint. Link 0 is the base. Joint i moves link i + 1, whose frame is
/// the frame of the joint after the motion of the joint.
template <typename Scalar = double, typename Name = std::string>
struct TreeJoint {
  Joint<Scalar, Name> joint = {};  ///< Placed in the frame of the link that carries the joint.
  int parent = 0;                  ///< Number of the link that carries the joint: at most the index of the joint.
};

/// A named frame of a link.
template <typename Scalar = double, typename Name = std::string>
struct NamedFrame {
  Name name = {};
  int link = 0;
  Transform<Scalar> offset = {};  ///< In the frame of the link.
};

/// Joints of a robot, in order: the joint that moves a link comes before the joints that this link carries. A Robot is
/// built from a tree. If the numbers of joints and frames are known at compile time, there is no heap allocation.
template <typename Scalar = double, int Joints = Eigen::Dynamic, int Frames = Joints>
struct Tree {
  std::array<TreeJoint<Scalar, std::string_view>, Joints> joints = {};
  std::array<NamedFrame<Scalar, std::string_view>, Frames> frames = {};
  LinkMass<Scalar> base = {};  ///< Mass of link 0.
};

template <typename Scalar>
struct Tree<Scalar, Eigen::Dynamic, Eigen::Dynamic> {
  std::vector<TreeJoint<Scalar>> joints;
  std::vector<NamedFrame<Scalar>> frames;
  LinkMass<Scalar> base = {};
};

/// Joint i of a tree.
template <typename Scalar, int Joints, int Frames>
[[nodiscard]] const auto& joint_of(const Tree<Scalar, Joints, Frames>& tree, Eigen::Index i) noexcept {
  return tree.joints[static_cast<std::size_t>(i)].joint;
}

/// Number of the link that carries joint i: in a chain, the link of the previous joint.
template <typename Scalar, int Joints, int Frames>
[[nodiscard]] int parent_of(const Tree<Scalar, Joints, Frames>& tree, Eigen::Index i) noexcept {
  return tree.joints[static_cast<std::size_t>(i)].parent;
}
template <typename Scalar, int Length>
[[nodiscard]] int parent_of(const Chain<Scalar, Length>&, Eigen::Index i) noexcept {
  return static_cast<int>(i);
}

/// Checks a tree and returns its number of joints. Throws std::invalid_argument if the number of joints exceeds kMaxDof
/// or is zero, a link does not come before the joint that it carries, the link of a frame does not exist, or a number
/// is out of range.
template <typename Scalar, int Joints, int Frames>
Eigen::Index require_tree(const Tree<Scalar, Joints, Frames>& tree) {
  validation::require_dof("joints", static_cast<Eigen::Index>(tree.joints.size()), 1);
  for (std::size_t i = 0; i < tree.joints.size(); ++i) {
    const validation::Argument name = chain_check::name_of(tree, static_cast<Eigen::Index>(i));
    const auto& [joint, parent] = tree.joints[i];
    chain_check::require_joint(name, joint);
    if (parent < 0 || parent > static_cast<int>(i)) {
      validation::fail(name + ".parent", parent, "the number of the parent link, at most ", static_cast<int>(i));
    }
  }
  for (std::size_t i = 0; i < tree.frames.size(); ++i) {
    const auto& [frame_name, link, offset] = tree.frames[i];
    const validation::Argument name = validation::element("frames", static_cast<Eigen::Index>(i));
    if (link < 0 || link > static_cast<int>(tree.joints.size())) {
      validation::fail(name + ".link", link, "the number of a link, at most ", static_cast<int>(tree.joints.size()));
    }
    chain_check::require_transform(name + ".offset", offset);
  }
  return static_cast<Eigen::Index>(tree.joints.size());
}

/// Adds an arm to a tree. The arm is placed in the frame of a link. The joint names begin with the name of the arm, and
/// the tip of the arm is the frame name_tip. Returns the number of the last link of the arm.
template <typename Scalar>
int add_arm(Tree<Scalar>& tree, const Chain<Scalar>& arm, const std::string& name, int link = 0,
            const Transform<Scalar>& placement = {}) {
  const auto first = static_cast<int>(tree.joints.size());
  for (const auto& [type, placed, axis, bounds, joint_name, mimic, moved, drive] : arm.joints) {
    const bool is_first = static_cast<int>(tree.joints.size()) == first;
    const Mimic<Scalar> follows{mimic.joint < 0 ? -1 : first + mimic.joint, mimic.ratio, mimic.offset};
    std::string own_name = name;
    own_name.append("_").append(joint_name);
    tree.joints.push_back(
        {{type, is_first ? placement * placed : placed, axis, bounds, own_name, follows, moved, drive}, link});
    link = static_cast<int>(tree.joints.size());
  }
  tree.frames.push_back({name + "_tip", link, arm.tip});
  return link;
}

/// Converts a chain to a tree. The frame "tip" is the tip of the chain.
template <typename Scalar, int Length>
[[nodiscard]] Tree<Scalar> tree_of(const Chain<Scalar, Length>& chain) {
  Tree<Scalar> tree;
  for (const auto& [type, placement, axis, bounds, name, mimic, moved, drive] : chain.joints) {
    const int parent = static_cast<int>(tree.joints.size());
    tree.joints.push_back({{type, placement, axis, bounds, std::string(name), mimic, moved, drive}, parent});
  }
  tree.frames.push_back({"tip", static_cast<int>(tree.joints.size()), chain.tip});
  return tree;
}

}  // namespace fpbm
