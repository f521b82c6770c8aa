#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Torque of a motion along a path, divided by its bound: rest + odd + even. A motion that is slower by a factor f has
/// the torque rest + odd/f + even/f².
struct ClockTorque {
  double rest;    ///< Gravity.
  double odd;     ///< Viscous friction.
  double even;    ///< Inertia and centrifugal forces.
  double change;  ///< Change of the torque with an acceleration of the clock.

  [[nodiscard]] double ratio() const noexcept { return rest + odd + even; }
  /// The factor by which the motion must be slower, so that the torque keeps its bound. The torque at rest is within
  /// the bound.
  [[nodiscard]] double slower() const noexcept {
    const auto least = [](double square, double linear, double slack) {
      const double root = linear * linear + 4.0 * square * slack;
      return root < 0.0 ? 0.0 : (linear + std::sqrt(root)) / (2.0 * slack);
    };
    return std::max(least(even, odd, 1.0 - rest), least(-even, -odd, 1.0 + rest));
  }
};

/// The torques of a motion with the velocities qd and accelerations qdd, for an acceleration of the clock along qd.
/// bounds: Bounds. Empty without bounds on torques. faster: factor of a reserve: the motion is faster, and all torques
/// are larger, by this factor.
template <typename Kept, int N>
[[nodiscard]] std::vector<ClockTorque> clock_torques(const Kept& bounds, const Vector<N>& q, const Vector<N>& qd,
                                                     const Vector<N>& qdd, double faster = 1.0) {
  std::vector<ClockTorque> torques;
  const auto rest = filled<Vector<N>>(q.size());
  bounds.torque_ratios(q, rest, rest, [&](double ratio) { torques.push_back({faster * ratio, 0.0, 0.0, 0.0}); });
  if (torques.empty()) return torques;
  const auto with = [&](const Vector<N>& of_v, const Vector<N>& of_a, const auto& set) {
    auto each = torques.begin();
    bounds.torque_ratios(q, of_v, of_a, [&](double ratio) { set(*each++, faster * ratio); });
  };
  const Vector<N> v = faster * qd;
  const Vector<N> a = faster * faster * qdd;
  with(rest, Vector<N>(faster * v), [](ClockTorque& torque, double ratio) { torque.change = ratio - torque.rest; });
  with(v, a, [](ClockTorque& torque, double ratio) { torque.even = ratio; });
  with(Vector<N>(-v), a, [](ClockTorque& torque, double ratio) {
    torque.odd = (torque.even - ratio) / 2.0;
    torque.even = (torque.even + ratio) / 2.0 - torque.rest;
  });
  return torques;
}

}  // namespace fpbm
