#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/bound/detail/gap_rows.hpp"
#include "fpbm/bound/detail/kept_fraction.hpp"
#include "fpbm/bound/detail/placed_robot.hpp"

namespace fpbm {

/// Lower bounds n·x ≥ offset on coordinates of points of links, or of unit vectors fixed to links: the walls and cones
/// of TaskBounds. The gap n·x − offset has rows like the distance of two shapes (GapRows), and the same certificate
/// (kept_fraction()).
template <int N, typename Scalar_ = double, int Joints = N>
class CoordinateBounds {
 public:
  using Scalar = Scalar_;
  using JointVector = Vector<N, Scalar>;
  using Vector3 = Vector<3, Scalar>;
  static constexpr int kRows = 8;
  static constexpr Status kStatus = Status::kBlocked;

  /// The bound n·x ≥ offset.
  struct Coordinate {
    LinkVector<Joints, Scalar> x;
    Vector3 n;
    Scalar offset;
    Scalar deceleration;  ///< Largest deceleration toward the bound [m/s²], or [1/s²] of a direction.
    std::string name;
  };

  /// source: the Tree or the Chain of the robot.
  template <typename Source>
  explicit CoordinateBounds(const Source& source) : placed_(source) {}

  /// Throws std::invalid_argument unless the deceleration is positive.
  void add(Coordinate coordinate) {
    if (!(coordinate.deceleration > Scalar(0))) {
      validation::fail("deceleration", coordinate.deceleration, "positive, or infinite");
    }
    coordinates_.push_back(std::move(coordinate));
    open_.resize(coordinates_.size());
  }
  [[nodiscard]] const PlacedRobot<N, Scalar, Joints>& placed() const noexcept { return placed_; }
  [[nodiscard]] const std::vector<Coordinate>& coordinates() const noexcept { return coordinates_; }
  [[nodiscard]] bool empty() const noexcept { return coordinates_.empty(); }

  /// Throws std::invalid_argument with the name of the bound if the posture q is beyond a bound.
  void require(const JointVector& q) {
    validation::require_size("joints of the task bounds", placed_.robot.dof(), q.size());
    placed_.place(q);
    const auto least = std::min_element(coordinates_.begin(), coordinates_.end(),
                                        [&](const auto& a, const auto& b) { return gap_of(a) < gap_of(b); });
    if (least != coordinates_.end() && !(gap_of(*least) >= Scalar(0))) {
      validation::reject("q0", ": is beyond the bound '" + least->name + "': must be within the task bounds");
    }
  }

  template <Level kLevel, int P>
  void rows(const NextMotion<kLevel, N, Scalar>& next, Rows<N, P, Scalar>& rows) noexcept {
    const auto& drives = placed_.robot.drives();
    const Motion motion(drives, next);
    const AllJoints fastest = drives.rates(Gaps::fastest(next, motion)).cwiseAbs() + motion.stop.deviation;
    const JointVector middle = motion.middle(next.state);
    placed_.place(middle);
    gaps_.begin(rows.count);
    const Eigen::Index before = rows.count;
    for (const Coordinate& each : coordinates_) {
      const Scalar gap = gap_of(each);
      const auto bound = displacement_of(each, motion.stop);
      const Scalar range = bound.c0 + bound.c1 + bound.c2 + each.x.levers.dot(fastest);
      if (!std::isfinite(each.deceleration) && gap >= range) continue;
      const AllJoints gradient = placed_.gradient(each.n, each.x);
      gaps_.add({gap, Gaps::slack_of(gap, gradient, bound, motion), gap + gradient.dot(motion.stop.line), Scalar(0),
                 each.deceleration},
                drives.by_drive(gradient), &each, motion, rows);
    }
    if (rows.count == before) return;
    placed_.place(JointVector(middle + motion.line));
    gaps_.finish(next, motion, rows, [&](const Coordinate* each) noexcept { return gap_of(*each); });
  }

  /// Calls f(gap, gradient) for each bound whose gap n·x − offset is below the range in the posture q [m, or 1 for a
  /// direction]. gradient: of the gap with respect to the drives.
  template <typename F>
  void gaps(const JointVector& q, Scalar range, const F& f) noexcept {
    placed_.place(q);
    for (const Coordinate& each : coordinates_) {
      const Scalar gap = gap_of(each);
      if (gap < range) f(gap, placed_.robot.drives().by_drive(placed_.gradient(each.n, each.x)));
    }
  }

  /// By conservative advancement, as in Advancement.
  template <Level kLevel>
  [[nodiscard]] bool accepts(const Limits<kLevel, N, Scalar>&, const State<N, Scalar>& from,
                             const Stop<kLevel, N, Scalar>& stop) noexcept {
    const StoppingMotion<Joints, Scalar> motion(placed_.robot.drives(), stop.displacement, stop.time);
    if (!motion.displacement.line.allFinite() || !motion.displacement.deviation.allFinite()) return false;
    Scalar done(0);
    placed_.place(from.q);
    for (std::size_t i = 0; i < open_.size(); ++i) {
      open_[i] = {Scalar(0), displacement_of(coordinates_[i], motion.displacement)};
    }
    for (int advance = 0; advance < kAdvances; ++advance) {
      const Scalar remaining = Scalar(1) - done;
      Scalar until(1);
      for (std::size_t i = 0; i < open_.size(); ++i) {
        auto& [proved, bound] = open_[i];
        if (!(proved < Scalar(1))) continue;
        const Scalar fraction = proved_fraction(coordinates_[i], bound, motion, remaining);
        proved = fraction == remaining ? Scalar(1) : std::max(proved, done + fraction);
        until = std::min(proved, until);
      }
      if (until == Scalar(1)) return true;
      if (!(until > done)) return false;
      done = until;
      placed_.place(JointVector(from.q + done * stop.displacement.line));
    }
    return false;
  }

 private:
  using AllJoints = Vector<Joints, Scalar>;
  using Motion = GapMotion<N, Joints, Scalar>;
  using Gaps = GapRows<kRows, N, Joints, Scalar, const Coordinate*>;

  /// Fraction of a stopping trajectory until which a bound is proved, and the displacement bound of the coordinate.
  struct Open {
    Scalar proved;
    DisplacementBound<Scalar> bound;
  };

  [[nodiscard]] Scalar gap_of(const Coordinate& each) const noexcept {
    return each.n.dot(placed_.in_base(each.x)) - each.offset;
  }
  [[nodiscard]] DisplacementBound<Scalar> displacement_of(
      const Coordinate& each, const JointDisplacement<Joints, Scalar>& displacement) const noexcept {
    DisplacementBound<Scalar> bound;
    bound.add(placed_.robot, each.x.levers, each.x.moved_by, displacement);
    return bound;
  }

  /// Fraction of the trajectory, at most `remaining`, in which the bound is proved. Beyond the bound, the coordinate
  /// must not move on.
  [[nodiscard]] Scalar proved_fraction(const Coordinate& each, const DisplacementBound<Scalar>& bound,
                                       const StoppingMotion<Joints, Scalar>& motion, Scalar remaining) const noexcept {
    const Scalar gap = gap_of(each);
    if (gap >= bound.displacement(remaining)) return remaining;
    const AllJoints gradient = placed_.gradient(each.n, each.x);
    if (gap < -kIntrusion<Scalar> && remaining == Scalar(1)) {
      const auto& p = motion.displacement;
      return gradient.dot(p.line) + p.least(gradient) >= Scalar(0) ? remaining : Scalar(0);
    }
    return kept_fraction(gap, gradient, bound, motion, remaining);
  }

  PlacedRobot<N, Scalar, Joints> placed_;
  std::vector<Coordinate> coordinates_;
  Gaps gaps_;
  std::vector<Open> open_;  ///< Memory of accepts().
};

}  // namespace fpbm
