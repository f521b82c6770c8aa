#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/clearance/away.hpp"
#include "fpbm/clearance/body.hpp"
#include "fpbm/clearance/link_capsule.hpp"
#include "fpbm/clearance/obstacle.hpp"
#include "fpbm/clearance/open_pairs.hpp"
#include "fpbm/model/links.hpp"
#include "fpbm/model/spread_posture.hpp"
#include "fpbm/task/link_frame.hpp"

namespace fpbm {

/// What an arm must keep clear of: itself and its surroundings, by a margin. Shapes of the world may move; all else is
/// settled at construction.
template <int N, typename Scalar = double>
class Clearance {
 public:
  using JointVector = Vector<N, Scalar>;
  using Vector3 = Vector<3, Scalar>;
  using ChainVector = typename Links<N, Scalar>::ChainVector;
  using Body = fpbm::Body<N, Scalar>;
  using Names = std::pair<std::string, std::string>;

  /// Most of the speed of a body over some coordinates of the base frame [m/s], or [rad/s] of a direction.
  struct SpeedBound {
    Body body;
    std::array<bool, 3> rows;
    Scalar most;
  };

  /// margin: least distance of a pair [m]. allowed: names of pairs that need not be kept apart. Links next to one
  /// another need not either. Throws std::invalid_argument where a number is out of range, a link does not exist, or
  /// the arm reaches beyond a prismatic joint without ends.
  Clearance(const Chain<Scalar>& chain, const std::vector<LinkCapsule<Scalar>>& capsules,
            const std::vector<Obstacle<Scalar>>& obstacles, Scalar margin, const std::vector<Names>& allowed = {})
      : links_(chain), tip_(chain.tip), obstacles_(obstacles), margin_(margin) {
    validation::require_non_negative("margin", margin);
    for (std::size_t i = 0; i < capsules.size(); ++i) {
      const auto& [link, capsule, name] = capsules[i];
      const validation::Argument argument = validation::element("capsules", static_cast<Eigen::Index>(i));
      capsules[i].require_sound(argument, links_.count());
      const Capsule<Scalar> placed{links_.in_frame(link, capsule.a), links_.in_frame(link, capsule.b), capsule.radius};
      bodies_.emplace_back(links_, link, placed, name);
      if (!bodies_.back().levers.allFinite()) {
        validation::reject(argument, " moves with a prismatic joint that has no ends");
      }
    }
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      obstacles_[i].require_sound(validation::element("obstacles", static_cast<Eigen::Index>(i)));
    }
    const auto is_allowed = [&allowed](const std::string& a, const std::string& b) {
      return std::any_of(allowed.begin(), allowed.end(),
                         [&](const Names& names) { return names == Names(a, b) || names == Names(b, a); });
    };
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (std::size_t j = 0; j < bodies_.size(); ++j) {
        if (bodies_[i].link <= bodies_[j].link + 1 || is_allowed(bodies_[i].name, bodies_[j].name)) continue;
        pairs_.push_back({i, j, false});
      }
      for (std::size_t j = 0; j < obstacles_.size(); ++j) {
        if (bodies_[i].link == 0 || is_allowed(bodies_[i].name, obstacles_[j].name)) continue;
        pairs_.push_back({i, j, true});
      }
    }
    shapes_ = bodies_.size();
    leave_out_overlaps(chain);
    open_.resize(pairs_.size());
    shape_pairs_ = pairs_.size();
  }

  [[nodiscard]] const Links<N, Scalar>& links() const noexcept { return links_; }
  [[nodiscard]] const std::vector<Body>& bodies() const noexcept { return bodies_; }
  [[nodiscard]] const std::vector<ShapePair>& pairs() const noexcept { return pairs_; }
  [[nodiscard]] const std::vector<Obstacle<Scalar>>& obstacles() const noexcept { return obstacles_; }
  [[nodiscard]] Scalar margin() const noexcept { return margin_; }
  [[nodiscard]] const typename Links<N, Scalar>::Frames& frames() const noexcept { return frames_; }

  [[nodiscard]] Names names(const ShapePair& pair) const {
    return {bodies_[pair.first].name, pair.world ? obstacles_[pair.second].name : bodies_[pair.second].name};
  }

  /// Number of pairs of shapes; the pairs behind these are bounds of tasks.
  [[nodiscard]] std::size_t shape_pairs() const noexcept { return shape_pairs_; }

  /// Pairs that overlap in all of many postures, which no motion could keep apart: left out.
  [[nodiscard]] const std::vector<ShapePair>& left_out() const noexcept { return left_out_; }

  /// Moves obstacle i, whose velocity is then expected to last. Does nothing, and says so, where there is no such
  /// obstacle, or it is a shape of another kind.
  bool move(std::size_t i, const WorldShape<Scalar>& shape, const Vector3& velocity) noexcept {
    if (i >= obstacles_.size() || obstacles_[i].shape.index() != shape.index()) return false;
    obstacles_[i].shape = shape;
    obstacles_[i].velocity = velocity;
    return true;
  }

  /// Keeps a distance in time, by self-motion. Throws std::invalid_argument where a number is out of range.
  void keep_away(const Away<Scalar>& away) {
    validation::require_non_negative("away.gain", away.gain);
    validation::require_positive("away.range", away.range);
    away_ = away;
  }
  [[nodiscard]] const Away<Scalar>& away() const noexcept { return away_; }

  /// Adds bounds on a task's coordinates: PositionBounds, AxisBounds. Throws std::invalid_argument as they do.
  template <typename Bounds>
  void keep(const Bounds& bounds) {
    bounds.add_to(*this);
  }

  /// The origin of a frame, as the body of a bound. Throws std::invalid_argument where there is no such link.
  [[nodiscard]] Body point_of(const LinkFrame<Scalar>& frame, const std::string& name) const {
    const auto [link, pose] = in_link(frame);
    return {links_, link, {links_.in_frame(link, pose.p), links_.in_frame(link, pose.p), -margin_}, name};
  }

  /// The same of an axis of a frame, a unit vector.
  [[nodiscard]] Body direction_of(const LinkFrame<Scalar>& frame, const Vector3& axis, const std::string& name) const {
    const auto [link, pose] = in_link(frame);
    return Body::direction(links_, link, links_.in_frame(link, pose.R * axis), -margin_, name);
  }

  /// Keeps n·x of the point x of a body at offset or above. The radius of the body, −margin(), takes the margin of
  /// shapes off. deceleration: most before the bound [1/s²].
  void keep_above(Body body, const Vector3& n, Scalar offset, Scalar deceleration) {
    if (!(deceleration > Scalar(0))) validation::fail("acceleration", deceleration, "positive, or infinite");
    body.deceleration = deceleration;
    pairs_.push_back({bodies_.size(), obstacles_.size(), true});
    obstacles_.push_back({body.name, HalfSpace<Scalar>{n, offset}});
    bodies_.push_back(std::move(body));
    open_.resize(pairs_.size());
  }

  /// Keeps the speed of a body at a bound or below. Throws std::invalid_argument unless that is positive.
  void bound_speed(SpeedBound bound) {
    if (!(bound.most > Scalar(0))) validation::fail("velocity", bound.most, "positive, or infinite");
    if (std::isfinite(bound.most)) speed_bounds_.push_back(std::move(bound));
  }
  [[nodiscard]] const std::vector<SpeedBound>& speed_bounds() const noexcept { return speed_bounds_; }

  /// Whether any obstacle moves by itself.
  [[nodiscard]] bool moves() const noexcept {
    return std::any_of(obstacles_.begin(), obstacles_.end(),
                       [](const auto& each) { return !each.velocity.isZero(Scalar(0)); });
  }

  /// Places the arm's capsules at a posture.
  void place(const JointVector& q) noexcept {
    links_.place(q, frames_);
    const auto frame = [this](const Body& body) -> const auto& {
      return frames_[static_cast<std::size_t>(body.link)];
    };
    for (std::size_t i = 0; i < shapes_; ++i) bodies_[i].place(frame(bodies_[i]));
    for (std::size_t i = shapes_; i < bodies_.size(); ++i) bodies_[i].place_in_bound(frame(bodies_[i]));
    for (SpeedBound& bound : speed_bounds_) bound.body.place_in_bound(frame(bound.body));
  }

  /// A lower bound on the distance of a pair where the arm is placed, found faster than nearest_of().
  [[nodiscard]] Scalar roughly(const ShapePair& pair) const noexcept {
    const Body& body = bodies_[pair.first];
    if (pair.world) return obstacles_[pair.second].at_least(body.centre, body.size);
    const Body& other = bodies_[pair.second];
    return (body.centre - other.centre).norm() - body.size - other.size;
  }

  [[nodiscard]] Nearest<Scalar> nearest_of(const ShapePair& pair) const noexcept {
    const Capsule<Scalar>& first = bodies_[pair.first].now;
    return pair.world ? obstacles_[pair.second].nearest_to(first) : nearest(first, bodies_[pair.second].now);
  }

  /// Sets how far each capsule's axis may be moved by joints of the chain that move by no more than so much.
  void set_reach(const ChainVector& most) noexcept {
    for (Body& body : bodies_) body.reach = body.levers.dot(most);
  }

  /// Pairs that a question is still open about, for who asks it.
  [[nodiscard]] OpenPairs& open() noexcept { return open_; }

  /// The pair of shapes that is nearest to one another where the arm is placed, and its distance; infinite without
  /// pairs.
  [[nodiscard]] std::pair<std::size_t, Scalar> nearest_pair() const noexcept { return nearest_pair(0, shape_pairs_); }

  /// The same of the pairs of shapes or the bounds of tasks from a number up to another.
  [[nodiscard]] std::pair<std::size_t, Scalar> nearest_pair(std::size_t first, std::size_t end) const noexcept {
    std::pair<std::size_t, Scalar> found{pairs_.size(), std::numeric_limits<Scalar>::infinity()};
    for (std::size_t i = first; i < end; ++i) {
      if (roughly(pairs_[i]) >= found.second) continue;
      const Scalar distance = nearest_of(pairs_[i]).distance;
      if (distance < found.second) found = {i, distance};
    }
    return found;
  }

 private:
  /// Link and pose of a frame in that of the link's joint.
  [[nodiscard]] std::pair<Eigen::Index, Transform<Scalar>> in_link(const LinkFrame<Scalar>& frame) const {
    constexpr int kTip = -1;
    if (frame.link() == kTip) return {links_.count(), tip_ * frame.offset()};
    if (frame.link() < 0 || frame.link() > links_.count()) {
      validation::fail("frame", frame.link(), "the number of a link, at most ", static_cast<int>(links_.count()));
    }
    return {frame.link(), frame.offset()};
  }

  void leave_out_overlaps(const Chain<Scalar>& chain) {
    if (pairs_.empty()) return;
    constexpr int kPostures = 256;
    std::vector<bool> apart(pairs_.size(), false);
    for (int k = 0; k < kPostures; ++k) {
      place(spread_posture(chain, k));
      for (std::size_t p = 0; p < pairs_.size(); ++p) {
        if (!apart[p]) apart[p] = roughly(pairs_[p]) >= margin_ || nearest_of(pairs_[p]).distance >= margin_;
      }
    }
    std::vector<ShapePair> kept;
    for (std::size_t p = 0; p < pairs_.size(); ++p) (apart[p] ? kept : left_out_).push_back(pairs_[p]);
    pairs_ = kept;
  }

  Links<N, Scalar> links_;
  Transform<Scalar> tip_;     ///< In the frame of the last joint.
  std::vector<Body> bodies_;  ///< Those of bounds of tasks come last.
  std::size_t shapes_ = 0;    ///< Number of bodies that are shapes.
  std::size_t shape_pairs_ = 0;
  std::vector<SpeedBound> speed_bounds_;
  std::vector<Obstacle<Scalar>> obstacles_;
  std::vector<ShapePair> pairs_;
  std::vector<ShapePair> left_out_;
  OpenPairs open_;
  Scalar margin_;
  Away<Scalar> away_;
  typename Links<N, Scalar>::Frames frames_;
};

}  // namespace fpbm
