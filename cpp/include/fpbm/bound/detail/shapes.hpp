#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/bound/detail/body.hpp"
#include "fpbm/bound/detail/link_capsule.hpp"
#include "fpbm/bound/detail/placement.hpp"
#include "fpbm/bound/obstacle.hpp"
#include "fpbm/model/detail/spread_posture.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// The shapes of a robot and its environment, and the pairs of shapes that must keep a margin: docs/clearance.md.
/// Obstacles may move. All other data are constant after construction. Joints: number of all joints, N by default;
/// Eigen::Dynamic for a robot with joints that follow others.
template <int N, typename Scalar_ = double, int Joints = N>
class Shapes {
 public:
  using Scalar = Scalar_;
  static constexpr int kJoints = Joints;
  using JointVector = Vector<N, Scalar>;
  using Vector3 = Vector<3, Scalar>;
  using Tree = Robot<N, Scalar, Joints>;  ///< With all joints: drives and followers.
  using AllJoints = Vector<Joints, Scalar>;
  using Body = fpbm::Body<Scalar, Joints>;
  using Placement = fpbm::Placement<N, Scalar, Joints>;
  using Names = std::pair<std::string, std::string>;

  /// source: the Tree or the Chain of the robot. margin: smallest distance of a pair [m]. allowed: names of pairs that
  /// are not checked. Pairs of a link and its parent link are not checked. Throws std::invalid_argument if a number is
  /// out of range, a link does not exist, or a prismatic joint without bounds is between a revolute joint and a
  /// capsule.
  template <typename Source>
  Shapes(const Source& source, const std::vector<LinkCapsule<Scalar>>& capsules,
         const std::vector<Obstacle<Scalar>>& obstacles, Scalar margin, const std::vector<Names>& allowed)
      : robot_(source), levers_(source), obstacles_(obstacles), margin_(margin) {
    validation::require_non_negative("margin", margin);
    for (std::size_t i = 0; i < capsules.size(); ++i) {
      const auto& [link, capsule, name] = capsules[i];
      const validation::Argument argument = validation::element("capsules", static_cast<Eigen::Index>(i));
      capsules[i].require_sound(argument, robot_.joints());
      bodies_.emplace_back(levers_, link, robot_.in_joint(link, {}), capsule, name);
      if (!bodies_.back().levers.allFinite()) reject_unbounded(robot_, source, argument, link);
    }
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      obstacles_[i].require_sound(validation::element("obstacles", static_cast<Eigen::Index>(i)));
    }
    const auto is_allowed = [&allowed](const std::string& a, const std::string& b) {
      return std::any_of(allowed.begin(), allowed.end(),
                         [&](const Names& names) { return names == Names(a, b) || names == Names(b, a); });
    };
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const int link = bodies_[i].link;
      const JointBits joints = robot_.moved_by(link);
      for (std::size_t j = 0; j < bodies_.size(); ++j) {
        const int earlier = bodies_[j].link;
        if (link <= earlier || robot_.parent(link) == earlier || is_allowed(bodies_[i].name, bodies_[j].name)) continue;
        const JointBits others = robot_.moved_by(earlier);
        pairs_.push_back({i, j, false, joints & ~others, others & ~joints});
      }
      for (std::size_t j = 0; j < obstacles_.size(); ++j) {
        if (link > 0 && !is_allowed(bodies_[i].name, obstacles_[j].name)) pairs_.push_back({i, j, true, joints, 0});
      }
    }
    exclude_overlaps();
  }

  [[nodiscard]] const Tree& robot() const noexcept { return robot_; }
  [[nodiscard]] const std::vector<Body>& bodies() const noexcept { return bodies_; }
  [[nodiscard]] const std::vector<ShapePair>& pairs() const noexcept { return pairs_; }
  [[nodiscard]] const std::vector<Obstacle<Scalar>>& obstacles() const noexcept { return obstacles_; }
  [[nodiscard]] Scalar margin() const noexcept { return margin_; }

  [[nodiscard]] Names names(const ShapePair& pair) const {
    return {bodies_[pair.first].name, pair.world ? obstacles_[pair.second].name : bodies_[pair.second].name};
  }

  /// Pairs that are not checked, because they are closer than the margin in all of many sampled postures.
  [[nodiscard]] const std::vector<ShapePair>& excluded_pairs() const noexcept { return excluded_pairs_; }

  /// Moves obstacle i. velocity: expected velocity of the obstacle after the call [m/s]. Returns false without effect
  /// if obstacle i does not exist or has another type of shape.
  bool move(std::size_t i, const WorldShape<Scalar>& shape, const Vector3& velocity) noexcept {
    if (i >= obstacles_.size() || obstacles_[i].shape.index() != shape.index()) return false;
    obstacles_[i].shape = shape;
    obstacles_[i].velocity = velocity;
    ++obstacles_[i].moves;
    return true;
  }

  /// Whether any obstacle has a velocity.
  [[nodiscard]] bool moves() const noexcept {
    return std::any_of(obstacles_.begin(), obstacles_.end(),
                       [](const auto& each) { return !each.velocity.isZero(Scalar(0)); });
  }

  /// Memory for place().
  [[nodiscard]] Placement placement() const {
    Placement placed;
    placed.bodies.resize(bodies_.size());
    placed.centres.resize(bodies_.size());
    return placed;
  }

  /// Computes the bodies in a posture. placed: a placement().
  void place(const JointVector& q, Placement& placed) const noexcept {
    robot_.update(q, placed.state);
    placed.axes.set(robot_, placed.state);
    for (std::size_t i = 0; i < placed.bodies.size(); ++i) {
      Capsule<Scalar>& body = placed.bodies[i];
      body = fpbm::placed(bodies_[i].in_link, placed.state.placement(static_cast<std::size_t>(bodies_[i].link)));
      placed.centres[i] = (body.a + body.b) / Scalar(2);
    }
  }

  /// Lower bound on the distance of a pair [m]. Cheaper than nearest_of().
  [[nodiscard]] Scalar distance_lower_bound(const Placement& placed, const ShapePair& pair) const noexcept {
    const Scalar size = bodies_[pair.first].size;
    const Vector3& centre = placed.centres[pair.first];
    if (pair.world) return obstacles_[pair.second].at_least(centre, size);
    return (centre - placed.centres[pair.second]).norm() - size - bodies_[pair.second].size;
  }

  [[nodiscard]] Nearest<Scalar> nearest_of(const Placement& placed, const ShapePair& pair) const noexcept {
    const Capsule<Scalar>& first = placed.bodies[pair.first];
    return pair.world ? obstacles_[pair.second].nearest_to(first) : nearest(first, placed.bodies[pair.second]);
  }

  /// The nearest pair of shapes in a posture and its distance [m]. The distance is infinite if there are no pairs.
  [[nodiscard]] std::pair<std::size_t, Scalar> nearest_pair(const JointVector& q) const {
    Placement memory = placement();
    return nearest_pair(q, memory);
  }
  /// The nearest pair of shapes, without an allocation. memory: a placement().
  [[nodiscard]] std::pair<std::size_t, Scalar> nearest_pair(const JointVector& q, Placement& memory) const noexcept {
    place(q, memory);
    return nearest_pair(memory);
  }

  [[nodiscard]] std::pair<std::size_t, Scalar> nearest_pair(const Placement& placed) const noexcept {
    std::pair<std::size_t, Scalar> found{pairs_.size(), std::numeric_limits<Scalar>::infinity()};
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (distance_lower_bound(placed, pairs_[i]) >= found.second) continue;
      const Scalar distance = nearest_of(placed, pairs_[i]).distance;
      if (distance < found.second) found = {i, distance};
    }
    return found;
  }

 private:
  void exclude_overlaps() {
    if (pairs_.empty()) return;
    // A pair that is clear in 2 % of independent postures would be excluded with a probability of 0.98²⁵⁶ = 0.6 %.
    constexpr int kPostures = 256;
    std::vector<bool> apart(pairs_.size(), false);
    Placement placed = placement();
    for (int k = 0; k < kPostures; ++k) {
      place(spread_posture(robot_.limits(), k), placed);
      for (std::size_t p = 0; p < pairs_.size(); ++p) {
        apart[p] = apart[p] || distance_lower_bound(placed, pairs_[p]) >= margin_ ||
                   nearest_of(placed, pairs_[p]).distance >= margin_;
      }
    }
    std::vector<ShapePair> kept;
    for (std::size_t p = 0; p < pairs_.size(); ++p) (apart[p] ? kept : excluded_pairs_).push_back(pairs_[p]);
    pairs_ = kept;
  }

  Tree robot_;
  Levers<Scalar> levers_;
  std::vector<Body> bodies_;
  std::vector<Obstacle<Scalar>> obstacles_;
  std::vector<ShapePair> pairs_;
  std::vector<ShapePair> excluded_pairs_;
  Scalar margin_;
};

}  // namespace fpbm
