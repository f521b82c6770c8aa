#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/bound/detail/displacement_bound.hpp"
#include "fpbm/bound/detail/joint_displacement.hpp"

namespace fpbm {

/// A negative gap whose magnitude is at most this value [m] is treated as round-off error: in double 4.5e6 ε, and in
/// float 84 ε, for distances of 1 m. In double, Bounds.moves_away_from_a_shape_that_jumped passes with 0 to 1e-6, and
/// fails with 1e-3.
template <typename Scalar>
inline constexpr Scalar kIntrusion = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-5);

/// Largest number of steps of a conservative advancement. In random motions among 26 near pairs, 16 steps accept 48,019
/// stopping trajectories, and 8 steps accept 48,002 of these trajectories. With 8 steps, the longest tick of a
/// clearance executes 25 % fewer instructions (bench/README.md, "The longest ticks"). With 2 steps, rejected ticks
/// increase the jerk in Bounds.slides_along_a_wall by a factor of 960.
inline constexpr int kAdvances = 8;

/// A stopping trajectory of all joints.
template <int Joints, typename Scalar>
struct StoppingMotion {
  JointDisplacement<Joints, Scalar> displacement;
  Vector<Joints, Scalar> start_velocity;  ///< Velocities of all joints at the start of the trajectory.
  Scalar time;                            ///< Duration of the trajectory [s].

  template <typename Drives, int N>
  StoppingMotion(const Drives& drives, const StopDisplacement<N, Scalar>& stop, const Scalar& time_) noexcept
      : displacement(drives, stop), start_velocity(drives.rates(stop.start_velocity)), time(time_) {}
};

/// Largest t ≤ remaining with gap − slope t − curvature t² ≥ 0; −1 if the gap is negative, or a number is NaN. The form
/// of the root avoids cancellation.
template <typename Scalar>
[[nodiscard]] Scalar largest_fraction(Scalar gap, Scalar slope, Scalar curvature, Scalar remaining) noexcept {
  using std::sqrt;
  if (!(gap >= Scalar(0))) return Scalar(-1);
  if (gap >= remaining * (slope + remaining * curvature)) return remaining;
  const Scalar t = Scalar(2) * gap / (slope + sqrt(slope * slope + Scalar(4) * curvature * gap));
  return t >= Scalar(0) ? t : Scalar(-1);
}

/// Fraction of a stopping trajectory, at most the fraction `remaining` that is left, in which a gap is proved not to be
/// negative: the smallest root of a lower bound on the gap (docs/clearance_proof.md, "Proof"). If no fraction is
/// proved, the result is not positive. gap: where the fraction `remaining` begins [m]. gradient: with respect to all
/// joints. bound: on the displacement of the points of the gap.
template <int Joints, typename Scalar>
[[nodiscard]] Scalar kept_fraction(const Scalar& gap, const Vector<Joints, Scalar>& gradient,
                                   const DisplacementBound<Scalar>& bound, const StoppingMotion<Joints, Scalar>& motion,
                                   const Scalar& remaining) noexcept {
  const JointDisplacement<Joints, Scalar>& p = motion.displacement;
  const Scalar slope = bound.c1 - std::min(gradient.dot(p.line), Scalar(0));
  const Scalar fraction = largest_fraction(gap - bound.c0 + p.least(gradient), slope, bound.c2, remaining);
  if (!(fraction < remaining) || remaining < Scalar(1) || !p.opens(gradient, motion.start_velocity)) return fraction;
  return std::max(largest_fraction(gap - bound.c0 + p.least_of_single_stops(gradient), bound.c1, bound.c2, remaining),
                  fraction);
}

}  // namespace fpbm
