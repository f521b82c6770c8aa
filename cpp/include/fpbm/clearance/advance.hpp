#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/clearance/separation.hpp"
#include "fpbm/limits/stop_plan.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// A sweep of a robot's drives, as one of its joints.
template <int N, typename Scalar>
struct JointSweep {
  using AllJoints = typename Clearance<N, Scalar>::AllJoints;

  AllJoints way;
  AllJoints tick;
  AllJoints low;
  AllJoints high;
  AllJoints rest;  ///< Most that all but `way` displaces a joint, either way.

  JointSweep(const Drives<N, Eigen::Dynamic, Scalar>& drives, const Sweep<N, Scalar>& sweep) noexcept
      : way(drives.rates(sweep.way)),
        tick(drives.rates(sweep.tick)),
        low(drives.least(sweep.low, sweep.high)),
        high(-drives.least(-sweep.high, -sweep.low)),
        rest(tick.cwiseAbs() + high.cwiseMax(-low)) {}

  /// Least that all but `way` adds to what has this gradient.
  [[nodiscard]] Scalar least(const AllJoints& gradient) const noexcept {
    return least_of_own(gradient) + std::min(gradient.dot(tick), Scalar(0));
  }
  /// The same of low and high alone.
  [[nodiscard]] Scalar least_of_own(const AllJoints& gradient) const noexcept {
    return gradient.cwiseProduct(low).cwiseMin(gradient.cwiseProduct(high)).sum();
  }
  /// Whether `way` and `tick` together never reduce what has this gradient. begun: of the sweep, by the joints.
  [[nodiscard]] bool opens(const AllJoints& gradient, const AllJoints& begun) const noexcept {
    return gradient.dot(begun) >= Scalar(0) && gradient.dot(tick) <= Scalar(0);
  }
};

/// What a sweep may take from a gap between shapes, t of its way done: at most linear·t + c₀ + c₁ t + c₂ t².
///
/// c bounds the gap's second derivative along the sweep: a turn of joint j by a and of a joint k beyond it by b bends
/// the way of a point at lever r of joint k by no more than r a b.
template <int N, typename Scalar>
struct Bend {
  Scalar c0 = Scalar(0);
  Scalar c1 = Scalar(0);
  Scalar c2 = Scalar(0);

  Bend(const Clearance<N, Scalar>& clearance, const ShapePair& pair, const JointSweep<N, Scalar>& sweep) noexcept {
    add(clearance, clearance.bodies()[pair.first], pair.by_first, sweep);
    if (pair.by_second != 0) add(clearance, clearance.bodies()[pair.second], pair.by_second, sweep);
  }

 private:
  /// That of the way of one body.
  void add(const Clearance<N, Scalar>& clearance, const Body<Scalar>& body, JointBits joints,
           const JointSweep<N, Scalar>& sweep) noexcept {
    Scalar way(0);  // Turned by joints so far.
    Scalar rest(0);
    each_joint(joints, [&](Eigen::Index k) noexcept {
      const Scalar lever = body.levers(k);
      const Scalar v = std::abs(sweep.way(k));
      const Scalar e = sweep.rest(k);
      const Scalar half = clearance.robot().turns(k) ? Scalar(0.5) : Scalar(0);
      c0 += lever * e * (half * e + rest);
      c1 += lever * (v * (Scalar(2) * half * e + rest) + e * way);
      c2 += lever * v * (half * v + way);
      way += Scalar(2) * half * v;
      rest += Scalar(2) * half * e;
    });
  }
};

/// Most that a sweep's way, t of it, and its rest can bring a pair nearer, by the levers of its joints.
template <int N, typename Scalar>
[[nodiscard]] Scalar reach(const Clearance<N, Scalar>& clearance, const ShapePair& pair,
                           const JointSweep<N, Scalar>& sweep, Scalar t) noexcept {
  Scalar sum(0);
  const auto add = [&](const Body<Scalar>& body, JointBits joints) noexcept {
    each_joint(joints,
               [&](Eigen::Index k) noexcept { sum += body.levers(k) * (t * std::abs(sweep.way(k)) + sweep.rest(k)); });
  };
  add(clearance.bodies()[pair.first], pair.by_first);
  if (pair.by_second != 0) add(clearance.bodies()[pair.second], pair.by_second);
  return sum;
}

/// What joints that take their own quickest stop may take from a gap, beyond its slope at their speed for some time.
template <int N, typename Scalar>
[[nodiscard]] Scalar beyond_slope(const JointSweep<N, Scalar>& sweep,
                                  const typename JointSweep<N, Scalar>::AllJoints& speed,
                                  const typename JointSweep<N, Scalar>::AllJoints& gradient, Scalar time) noexcept {
  Scalar beyond(0);
  for (Eigen::Index k = 0; k < gradient.size(); ++k) {
    const Scalar least = std::min(gradient(k) * sweep.low(k), gradient(k) * sweep.high(k));
    const Scalar slope = std::min(gradient(k) * speed(k) * time, Scalar(0));
    beyond += std::max(slope - least, Scalar(0));
  }
  return beyond;
}

/// Most of a gap's rest of the way, up to `whole`, that surely leaves a gap above zero; below zero where there is none.
template <typename Scalar>
[[nodiscard]] Scalar furthest(Scalar gap, Scalar slope, Scalar bend, Scalar whole) noexcept {
  using std::sqrt;
  if (!(gap >= Scalar(0))) return Scalar(-1);
  if (gap >= whole * (slope + whole * bend)) return whole;
  return Scalar(2) * gap / (slope + sqrt(slope * slope + Scalar(4) * bend * gap));
}

/// Pairs that keeps_apart() is asked about.
enum class Pairs : unsigned char {
  kAll,
  kAtRest,  ///< All but those with a shape that moves by itself.
};

/// Whether all pairs surely keep their margin along a sweep from the posture q, where the clearance is placed: by
/// conservative advancement, in kAdvances steps at most. Each goes as far as the nearest pair's gap, its slope there
/// and a bound on its bend allow for sure. Pairs that are sure to the sweep's end are not looked at again. Of a pair
/// that is nearer than its margin from the start, because a shape has moved, it is enough that it comes no nearer.
/// time: that of the sweep, in which moving shapes go on [s].
template <int N, typename Scalar>
[[nodiscard]] bool keeps_apart(Clearance<N, Scalar>& clearance, const Vector<N, Scalar>& q,
                               const Sweep<N, Scalar>& drives, Scalar time, Pairs pairs = Pairs::kAll) noexcept {
  // Of 48,019 stops of random motions among 26 near pairs that 16 advances accept, 8 accept 48,002. The worst tick of a
  // clearance takes 25 % fewer instructions with 8 (bench/README.md, "The longest ticks").
  constexpr int kAdvances = 8;
  constexpr Scalar kIntrusion = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-5);  // [m]
  const auto all = [&](Eigen::Index i) {
    return drives.way.coeff(i) + drives.tick.coeff(i) + drives.low.coeff(i) + drives.high.coeff(i);
  };
  if (!is_finite(entrywise(drives.way, all))) return false;
  const JointSweep<N, Scalar> sweep(clearance.robot().drives(), drives);
  const auto begun = clearance.robot().drives().rates(drives.begun);
  clearance.set_reach(sweep.way.cwiseAbs() + sweep.rest);
  OpenPairs& open = clearance.open();
  open.open_all();
  Scalar done(0);
  for (int advance = 0; advance < kAdvances; ++advance) {
    const Scalar whole = Scalar(1) - done;
    Scalar step = whole;
    open.close_if([&](std::size_t number) noexcept {
      const ShapePair& pair = clearance.pairs()[number];
      const Scalar moves = pair.world ? time * clearance.obstacles()[pair.second].velocity.norm() : Scalar(0);
      if (moves > Scalar(0) && pairs == Pairs::kAtRest) return true;
      const Scalar most = clearance.margin() + moves;
      if (clearance.roughly(pair) >= most + clearance.reach_of(pair)) return true;
      const Scalar needs = most + reach(clearance, pair, sweep, whole);
      const Nearest<Scalar> nearest = clearance.nearest_of(pair);
      if (nearest.distance >= needs) return true;
      const Separation<N, Scalar> plane(clearance, pair, nearest);
      if (nearest.distance < clearance.margin() - kIntrusion && done == Scalar(0)) {
        const auto gradient = plane.of_distance();
        const bool opens = gradient.dot(sweep.way) + sweep.least(gradient) >= Scalar(0);
        if (!opens) step = Scalar(0);
        return opens;
      }
      const Bend<N, Scalar> bend(clearance, pair, sweep);
      Scalar sure = whole;
      for (int k = 0; k < 2 * plane.seconds; ++k) {
        const auto g = plane.gradient_of(k % 2, k / 2);
        const Scalar gap =
            plane.gap(k % 2, k / 2) - clearance.margin() - bend.c0 - time * std::max(plane.closing, Scalar(0));
        const Scalar slope = bend.c1 - std::min(g.dot(sweep.way), Scalar(0));
        Scalar far = furthest(gap + sweep.least(g), slope, bend.c2, whole);
        if (far < whole && done == Scalar(0) && sweep.opens(g, begun)) {
          far = std::max(furthest(gap + sweep.least_of_own(g), bend.c1, bend.c2, whole), far);
        }
        sure = std::min(far, sure);  // In this order NaN stays.
      }
      step = std::min(sure, step);
      return sure == whole;
    });
    if (!(step > Scalar(0))) return false;
    if (step == whole) return true;
    done += step;
    clearance.place(q + done * drives.way);
  }
  return false;
}

}  // namespace fpbm
