#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "fpbm/clearance/advance.hpp"

namespace fpbm {

/// Bounds on the displacement of a body's points over a sweep, t of its way done: at most d₀ + d₁ t, and at most
/// c₀ + c₁ t + c₂ t² from the linear displacement.
///
/// c bounds the second derivative along the sweep: if joint j turns by a and a joint k beyond it by b, a point at lever
/// r of joint k deviates by at most r a b.
template <typename Scalar>
struct DisplacementBound {
  Scalar d0 = Scalar(0);
  Scalar d1 = Scalar(0);
  Scalar c0 = Scalar(0);
  Scalar c1 = Scalar(0);
  Scalar c2 = Scalar(0);

  [[nodiscard]] Scalar displacement(Scalar t) const noexcept { return d0 + t * d1; }

  /// Adds the displacement of a body by joints.
  template <typename Clearance>
  void add(const Clearance& clearance, const typename Clearance::Body& body, JointBits joints,
           const JointSweep<Clearance>& sweep) noexcept {
    Scalar way(0);  // Turned by joints so far.
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

/// The displacement bounds of the pairs of a clearance over one sweep. Those of a body and a shape of the world are
/// computed once for each body.
template <typename Clearance>
class DisplacementBounds {
 public:
  using Bound = DisplacementBound<typename Clearance::Scalar>;

  explicit DisplacementBounds(const Clearance& clearance)
      : by_body_(clearance.bodies().size()), is_known_(clearance.bodies().size(), 0) {}

  /// Forgets the sweep before.
  void begin() noexcept { is_known_.assign(is_known_.size(), 0); }

  /// The bound of both shapes of a pair together. sweep: the same since begin().
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
