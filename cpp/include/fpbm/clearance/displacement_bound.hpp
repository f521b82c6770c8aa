#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "fpbm/clearance/advance.hpp"

namespace fpbm {

/// Bounds on the displacement of a point of a body, after the fraction t of a stopping trajectory [m]
/// (docs/clearance.md, "Proof"):
///
///   displacement:                                        at most d₀ + d₁t
///   deviation from the linear displacement J(t·p + r):   at most c₀ + c₁t + c₂t²
///
/// Let x_k = |p_k|t + e_k be the largest displacement of joint k, and r_k the lever of joint k. Then
///
///   d₀ + d₁t = Σ_k r_k x_k,        c₀ + c₁t + c₂t² = Σ_k r_k x_k (x_k/2 + Σ_{j<k} x_j),
///
/// where the factor in brackets contains revolute joints only. This is the second-order term: if joint j rotates by α,
/// and joint k later in the chain by β, a point deviates by at most r_k αβ.
template <typename Scalar>
struct DisplacementBound {
  Scalar d0 = Scalar(0);
  Scalar d1 = Scalar(0);
  Scalar c0 = Scalar(0);
  Scalar c1 = Scalar(0);
  Scalar c2 = Scalar(0);

  [[nodiscard]] Scalar displacement(Scalar t) const noexcept { return d0 + t * d1; }

  /// Adds the terms of `joints` to the bounds: the joints that move the body.
  template <typename Clearance>
  void add(const Clearance& clearance, const typename Clearance::Body& body, JointBits joints,
           const JointSweep<Clearance>& sweep) noexcept {
    Scalar way(0);  // Σ |p_j| of the revolute joints before joint k. `rest` is Σ e_j.
    Scalar rest(0);
    each_joint(joints, [&](Eigen::Index k) noexcept {
      const Scalar lever = body.levers(k);
      const Scalar v = std::abs(sweep.way(k));
      const Scalar e = sweep.rest(k);
      const Scalar half = clearance.robot().turns(k) ? Scalar(0.5) : Scalar(0);
      d0 += lever * e;
      d1 += lever * v;
      c0 += lever * e * (half * e + rest);
      c1 += lever * (v * (Scalar(2) * half * e + rest) + e * way);
      c2 += lever * v * (half * v + way);
      way += Scalar(2) * half * v;
      rest += Scalar(2) * half * e;
    });
  }
};

/// Displacement bounds of the pairs of a clearance along one stopping trajectory. The bound of a body and an obstacle
/// is computed once for each body.
template <typename Clearance>
class DisplacementBounds {
 public:
  using Bound = DisplacementBound<typename Clearance::Scalar>;

  explicit DisplacementBounds(const Clearance& clearance)
      : by_body_(clearance.bodies().size()), is_known_(clearance.bodies().size(), 0) {}

  /// Discards the bounds of the previous trajectory.
  void begin() noexcept { is_known_.assign(is_known_.size(), 0); }

  /// Sum of the bounds of both shapes of a pair. sweep: the same trajectory in all calls after begin().
  [[nodiscard]] Bound of(const Clearance& clearance, const ShapePair& pair,
                         const JointSweep<Clearance>& sweep) noexcept {
    const auto& first = clearance.bodies()[pair.first];
    if (!pair.world) {
      Bound bound;
      bound.add(clearance, first, pair.by_first, sweep);
      if (pair.by_second != 0) bound.add(clearance, clearance.bodies()[pair.second], pair.by_second, sweep);
      return bound;
    }
    if (is_known_[pair.first] == 0) {
      by_body_[pair.first] = {};
      by_body_[pair.first].add(clearance, first, pair.by_first, sweep);
      is_known_[pair.first] = 1;
    }
    return by_body_[pair.first];
  }

 private:
  std::vector<Bound> by_body_;
  std::vector<unsigned char> is_known_;
};

}  // namespace fpbm
