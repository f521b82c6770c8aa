#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/linalg/detail/three.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// Bounds on the displacement of points of links by each joint, valid in every posture (docs/clearance_proof.md, "Near
/// pairs").
template <typename Scalar = double, int Joints = Eigen::Dynamic>
class Levers {
 public:
  using JointVector = Vector<Joints, Scalar>;

  /// source: a checked Tree or Chain.
  template <typename Source>
  explicit Levers(const Source& source) {
    for (; count_ < static_cast<Eigen::Index>(source.joints.size()); ++count_) {
      const auto& joint = joint_of(source, count_);
      const bool turns = joint.type != JointType::kPrismatic;
      using std::abs;
      const Scalar range = turns ? Scalar(0) : std::max(abs(joint.bounds.lower), abs(joint.bounds.upper));
      joints_[static_cast<std::size_t>(count_)] = {joint.placement.p, normalized(joint.axis), range, turns,
                                                   parent_of(source, count_)};
    }
  }

  /// Levers r_k ≥ ‖∂x/∂q_k‖ of a point x of a link, in every posture [m/rad, or 1 for a prismatic joint]. point: x in
  /// the frame of the link [m].
  ///
  /// The distance from x to the axis of a revolute joint is at most the length of the chain from the axis to x, without
  /// the component of the first link along the axis. A lever is infinite if a prismatic joint without bounds is in this
  /// chain, and 0 if joint k does not move the link.
  [[nodiscard]] JointVector operator()(int link, const Vector<3, Scalar>& point) const {
    JointVector lever = filled<JointVector>(count_);
    Scalar beyond = Scalar(0);  // Length of the chain from the origin of the next joint to the point [m].
    Vector<3, Scalar> step = point;
    while (link > 0) {
      const auto& [place, axis, range, turns, parent] = joints_[static_cast<std::size_t>(link - 1)];
      lever(link - 1) = turns ? norm(cross(axis, step)) + beyond : Scalar(1);
      beyond += norm(step) + range;
      step = place;
      link = parent;
    }
    return lever;
  }

 private:
  struct Joint {
    Vector<3, Scalar> place;  ///< In the frame of the link that carries the joint.
    Vector<3, Scalar> axis;   ///< Unit vector.
    Scalar range;             ///< Largest displacement of a prismatic joint from zero [m].
    bool turns;
    int parent;
  };

  std::array<Joint, static_cast<std::size_t>(kCapacity<Joints>)> joints_;
  Eigen::Index count_ = 0;
};

/// Throws the error of a capsule with an infinite lever: a prismatic joint without bounds is between a revolute joint
/// and the capsule. A mobile base whose revolute joint is last has finite levers. source: the Tree or the Chain of the
/// robot.
template <typename Robot_, typename Source>
[[noreturn]] void reject_unbounded(const Robot_& robot, const Source& source, const validation::Argument& argument,
                                   int link) {
  bool turns = false;
  std::string_view rail;
  each_joint(robot.moved_by(link), [&](Eigen::Index k) {
    const auto& joint = joint_of(source, k);
    turns = turns || robot.turns(k);
    const bool bounded = std::isfinite(joint.bounds.lower) && std::isfinite(joint.bounds.upper);
    if (turns && !robot.turns(k) && !bounded) rail = joint.name;
  });
  if (!rail.empty()) {
    validation::reject(argument, ".link = ", link, ": moves with the prismatic joint '", rail,
                       "', which has no bounds, after a revolute joint: give the joint lower and upper bounds");
  }
  validation::reject(argument, ": is too large: its lever about a joint must be finite");
}

}  // namespace fpbm
