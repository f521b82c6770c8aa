#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "fpbm/linalg/three.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// Bounds on the displacement of points of a robot's links by each joint, in every posture.
template <typename Scalar = double>
class Levers {
 public:
  using JointVector = Vector<Eigen::Dynamic, Scalar>;

  /// source: a checked Tree or Chain.
  template <typename Source>
  explicit Levers(const Source& source) {
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(source.joints.size()); ++i) {
      const auto& joint = joint_of(source, i);
      const bool turns = joint.type != JointType::kPrismatic;
      using std::abs;
      const Scalar range = turns ? Scalar(0) : std::max(abs(joint.bounds.lower), abs(joint.bounds.upper));
      joints_.push_back({joint.placement.p, normalized(joint.axis), range, turns, parent_of(source, i)});
    }
  }

  /// Lever k bounds the displacement of a point of a link [m], given in the link's frame, per unit of joint k [rad] or
  /// [m]. The distance from the point to the axis of a turning joint is at most the length of the chain between them,
  /// where the first link counts without its component along the axis. Infinite if a prismatic joint without bounds is
  /// in that chain; 0 if joint k does not move the link.
  [[nodiscard]] JointVector operator()(int link, const Vector<3, Scalar>& point) const {
    JointVector lever = filled<JointVector>(static_cast<Eigen::Index>(joints_.size()));
    Scalar beyond = Scalar(0);  // Length of the chain from the next joint's origin to the point [m].
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
    Vector<3, Scalar> place;  ///< In the frame of the link that carries it.
    Vector<3, Scalar> axis;   ///< Of length 1.
    Scalar range;             ///< Most that a prismatic joint slides, either way.
    bool turns;
    int parent;
  };

  std::vector<Joint> joints_;
};

}  // namespace fpbm
