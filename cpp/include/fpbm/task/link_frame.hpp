#pragma once

#include <string>
#include <string_view>

#include "fpbm/core/rotation.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// A frame fixed to a link of a robot, which a task refers to.
template <typename Scalar = double>
class LinkFrame {
 public:
  /// link: as Robot counts links; Robot::kTip is the tip. offset: the frame in that of the link.
  /// Throws std::invalid_argument where the offset is not finite or no rigid transformation.
  LinkFrame(int link, const Transform<Scalar>& offset = {}) : link_(link), offset_(offset) {
    chain_check::require_transform("offset", offset);
  }

  [[nodiscard]] int link() const noexcept { return link_; }
  [[nodiscard]] const Transform<Scalar>& offset() const noexcept { return offset_; }

  /// Call before at(). Throws std::invalid_argument where the robot has no such link.
  template <typename Robot>
  void bind(const Robot& robot) {
    robot.require_link("frame", link_);
    in_joint_ = robot.in_joint(link_, offset_);
  }

  /// The frame in the base frame.
  template <typename Robot>
  [[nodiscard]] Transform<Scalar> at(const Robot& robot, const typename Robot::State& state) const noexcept {
    return robot.frame(state, link_, in_joint_);
  }
  /// Its axes, the columns.
  template <typename Robot>
  [[nodiscard]] Matrix<3, 3, Scalar> axes(const Robot& robot, const typename Robot::State& state) const noexcept {
    return robot.axes(state, link_, in_joint_.R);
  }
  /// Its origin.
  template <typename Robot>
  [[nodiscard]] Vector<3, Scalar> origin(const Robot& robot, const typename Robot::State& state) const noexcept {
    return robot.point(state, link_, in_joint_.p);
  }

 private:
  int link_;
  Transform<Scalar> offset_;
  Transform<Scalar> in_joint_;  ///< The frame seen from the link's joint.
};

/// The frame of a tree by name. Throws std::invalid_argument where there is none.
template <typename Scalar, int Joints, int Frames>
[[nodiscard]] LinkFrame<Scalar> frame_of(const Tree<Scalar, Joints, Frames>& tree, std::string_view name) {
  for (const auto& [other, link, offset] : tree.frames) {
    if (other == name) return {link, offset};
  }
  std::string known;
  for (const auto& frame : tree.frames) known += " '" + std::string(frame.name) + "'";
  validation::reject("frame", " = '" + std::string(name) + "': must be one of the tree's:" + known);
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
