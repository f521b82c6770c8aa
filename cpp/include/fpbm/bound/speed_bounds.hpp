#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/bound/detail/placed_robot.hpp"

namespace fpbm {

/// Bound on the speed of the origin of a frame, or of an axis of a frame:
///
///   ‖(ṗᵢ)‖ ≤ velocity, over the coordinates of `rows`        ‖ȧ‖ ≤ velocity
template <typename Scalar = double>
struct SpeedBound {
  LinkFrame<Scalar> frame;
  Scalar velocity;                                ///< [m/s], or [rad/s] of an axis.
  std::array<bool, 3> rows = {true, true, true};  ///< Coordinates that the speed includes.
  std::optional<Vector<3, Scalar>> axis = {};     ///< In the frame. Any positive length.
};

/// Bound of a Tracker: speeds of points and axes. Without a certificate: the speeds hold as far as the joint limits and
/// the other bounds admit.
template <int N, typename Scalar_ = double, int Joints = N>
class SpeedBounds {
 public:
  using Scalar = Scalar_;
  using JointVector = Vector<N, Scalar>;
  static constexpr int kRows = 8;
  static constexpr Status kStatus = Status::kSlowed;

  /// source: the Tree or the Chain of the robot.
  template <typename Source>
  explicit SpeedBounds(const Source& source) : placed_(source) {}

  /// Throws std::invalid_argument if the bound is not positive, the axis is zero, or the link does not exist.
  void keep(const SpeedBound<Scalar>& bound) {
    if (!(bound.velocity > Scalar(0))) validation::fail("velocity", bound.velocity, "positive, or infinite");
    const auto x =
        bound.axis ? placed_.direction(bound.frame, unit_vector("axis", *bound.axis)) : placed_.point(bound.frame);
    if (std::isfinite(bound.velocity)) speeds_.push_back({x, bound.rows, bound.velocity});
  }

  [[nodiscard]] bool empty() const noexcept { return speeds_.empty(); }
  void require(const JointVector& q) const {
    validation::require_size("joints of the speed bounds", placed_.robot.dof(), q.size());
  }

  /// Adds a row n·v ≤ velocity for each speed that the motion u would exceed. The direction of v after the whole tick
  /// may differ from the direction after the fraction next.least_fraction: if this fraction is below 1, rows are added
  /// for both.
  template <Level kLevel, int P>
  void rows(const NextMotion<kLevel, N, Scalar>& next, Rows<N, P, Scalar>& rows) noexcept {
    const Eigen::Index most = rows.count + kRows;
    add_rows(next, Scalar(1), most, rows);
    if (next.least_fraction < Scalar(1)) add_rows(next, next.least_fraction, most, rows);
  }

  /// Largest ratio of a speed to its bound.
  [[nodiscard]] Scalar speed_ratio(const JointVector& q, const JointVector& qd) noexcept {
    placed_.place(q);
    Scalar largest(0);
    for (const Speed& speed : speeds_) {
      const Scalar ratio = velocity(speed, qd).norm() / speed.most;
      if (ratio > largest) largest = ratio;
    }
    return largest;
  }

  /// No posture is beyond a bound on speed.
  template <typename F>
  void gaps(const JointVector&, Scalar, const F&) const noexcept {}

  template <Level kLevel>
  [[nodiscard]] static bool accepts(const Limits<kLevel, N, Scalar>&, const State<N, Scalar>&,
                                    const Stop<kLevel, N, Scalar>&) noexcept {
    return true;
  }

 private:
  struct Speed {
    LinkVector<Joints, Scalar> x;
    std::array<bool, 3> rows;
    Scalar most;
  };

  /// Rows for the motion `fraction` u.
  ///
  /// v is the velocity of x after the tick and after the acceleration is reduced to zero. The joint velocities are then
  /// q̇ + acting_ticks h u, or q̇ + acting_ticks (u − q̇) at velocity level. n is the direction of v. The speed may still
  /// exceed the bound because the direction changes within the tick, or if the other rows and the joint limits admit no
  /// motion within the bound.
  template <Level kLevel, int P>
  void add_rows(const NextMotion<kLevel, N, Scalar>& next, Scalar fraction, Eigen::Index most,
                Rows<N, P, Scalar>& rows) noexcept {
    // The joint velocities after the tick are `constant` + g u.
    const Scalar h = next.limits.tick();
    const Scalar acting = next.acting_ticks;
    const JointVector& qd = next.state.qd;
    const Scalar g = kLevel == Level::kAcceleration ? acting * h : acting;
    const JointVector constant = kLevel == Level::kAcceleration ? qd : JointVector((Scalar(1) - acting) * qd);
    const JointVector final = constant + g * fraction * next.u;
    placed_.place(JointVector(next.state.q + h / Scalar(2) * (qd + final)));
    for (const Speed& speed : speeds_) {
      const Vector<3, Scalar> v = velocity(speed, final);
      const Scalar size = v.norm();
      if (!(size > speed.most) || rows.count == most) continue;
      const JointVector row = gradient(speed, v / size);
      rows.g.col(rows.count) = g * row;
      rows.b(rows.count++) = speed.most - row.dot(constant);
    }
  }

  [[nodiscard]] JointVector gradient(const Speed& speed, const Vector<3, Scalar>& n) const noexcept {
    return placed_.robot.drives().by_drive(placed_.gradient(n, speed.x));
  }
  /// Velocity over the bounded coordinates at the joint velocities qd, in the posture that placed_ has.
  [[nodiscard]] Vector<3, Scalar> velocity(const Speed& speed, const JointVector& qd) const noexcept {
    Vector<3, Scalar> v = Vector<3, Scalar>::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      if (!speed.rows[static_cast<std::size_t>(axis)]) continue;
      v(axis) = gradient(speed, Vector<3, Scalar>::Unit(axis)).dot(qd);
    }
    return v;
  }

  PlacedRobot<N, Scalar, Joints> placed_;
  std::vector<Speed> speeds_;
};

}  // namespace fpbm
