#pragma once

#include <string>
#include <string_view>

#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// Frame fixed to a link of a robot, for tasks.
template <typename Scalar = double>
class LinkFrame {
 public:
  /// link: number of the link as in Robot, or Robot::kTip for the tip. offset: the frame in the frame of the link.
  /// Throws std::invalid_argument if the offset is not finite or not a rigid transformation.
  LinkFrame(int link, const Transform<Scalar>& offset = {}) : link_(link), offset_(offset) {
    chain_check::require_transform("offset", offset);
  }

  [[nodiscard]] int link() const noexcept { return link_; }
  [[nodiscard]] const Transform<Scalar>& offset() const noexcept { return offset_; }

  /// Call before at(). Throws std::invalid_argument if the link does not exist in the robot.
  template <typename Robot>
  void bind(const Robot& robot) {
    robot.require_link("frame", link_);
    in_joint_ = robot.in_joint(link_, offset_);
  }

  /// Pose of the frame in the base frame.
  template <typename Robot>
  [[nodiscard]] Transform<Scalar> at(const Robot& robot, const typename Robot::State& state) const noexcept {
    return robot.frame(state, link_, in_joint_);
  }
  /// Axes of the frame in the base frame, as columns.
  template <typename Robot>
  [[nodiscard]] Matrix<3, 3, Scalar> axes(const Robot& robot, const typename Robot::State& state) const noexcept {
    return robot.axes(state, link_, in_joint_.R);
  }
  /// Origin of the frame in the base frame [m].
  template <typename Robot>
  [[nodiscard]] Vector<3, Scalar> origin(const Robot& robot, const typename Robot::State& state) const noexcept {
    return robot.point(state, link_, in_joint_.p);
  }

 private:
  int link_;
  Transform<Scalar> offset_;
  Transform<Scalar> in_joint_;  ///< The frame relative to the placement of the joint of the link.
};

/// Frame of a tree by name. Throws std::invalid_argument if the name does not exist.
template <typename Scalar, int Joints, int Frames>
[[nodiscard]] LinkFrame<Scalar> frame_of(const Tree<Scalar, Joints, Frames>& tree, std::string_view name) {
  for (const auto& [other, link, offset] : tree.frames) {
    if (other == name) return {link, offset};
  }
  std::string known;
  for (const auto& frame : tree.frames) known += " '" + std::string(frame.name) + "'";
  validation::reject("frame", " = '" + std::string(name) + "': must be a frame of the tree:" + known);
}

/// Throws std::invalid_argument unless the M entries of a list are different numbers from 0 to count − 1.
template <typename List>
void require_different(const char* name, const List& list, int count) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i] < 0 || list[i] >= count) {
      validation::fail(validation::element(name, static_cast<Eigen::Index>(i)), list[i], "from 0 to ", count - 1);
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (list[j] == list[i]) {
        validation::fail(validation::element(name, static_cast<Eigen::Index>(i)), list[i], "different from the others");
      }
    }
  }
}

}  // namespace fpbm
