#pragma once

#include <cmath>

#include "fpbm/bound/detail/joint_displacement.hpp"

namespace fpbm {

/// Bounds on the displacement of a point of a body, after the fraction t of a stopping trajectory [m]
/// (docs/clearance_proof.md, "Proof"). The displacement of the joints is t·p + r with |r| ≤ e, where p is
/// JointDisplacement::line, and e is JointDisplacement::deviation. The bounds on the point are
///
///   displacement:                                        at most d₀ + d₁t
///   deviation from the linear displacement J(t·p + r):   at most c₀ + c₁t + c₂t²
///
/// Let x_k = |p_k|t + e_k be the largest displacement of joint k, and r_k the lever of joint k. Then
///
///   d₀ + d₁t = Σ_k r_k x_k,        c₀ + c₁t + c₂t² = Σ_k r_k x_k (x_k/2 + Σ_{j<k} x_j),
///
/// where the factor in brackets contains revolute joints only. The second sum is the second-order term: if joint j
/// rotates by α, and joint k later in the chain by β, a point deviates by at most r_k αβ.
template <typename Scalar>
struct DisplacementBound {
  Scalar d0 = Scalar(0);
  Scalar d1 = Scalar(0);
  Scalar c0 = Scalar(0);
  Scalar c1 = Scalar(0);
  Scalar c2 = Scalar(0);

  [[nodiscard]] Scalar displacement(Scalar t) const noexcept { return d0 + t * d1; }

  /// Adds the terms of `joints`, the joints that move the point, to the bounds. levers: of the point.
  template <typename Robot, int Joints>
  void add(const Robot& robot, const Vector<Joints, Scalar>& levers, JointBits joints,
           const JointDisplacement<Joints, Scalar>& displacement) noexcept {
    Scalar line(0);       // Σ |p_j| of the revolute joints before joint k.
    Scalar deviation(0);  // Σ e_j of the revolute joints before joint k.
    each_joint(joints, [&](Eigen::Index k) noexcept {
      const Scalar lever = levers(k);
      const Scalar v = std::abs(displacement.line(k));
      const Scalar e = displacement.deviation(k);
      const Scalar half = robot.turns(k) ? Scalar(0.5) : Scalar(0);
      d0 += lever * e;
      d1 += lever * v;
      c0 += lever * e * (half * e + deviation);
      c1 += lever * (v * (Scalar(2) * half * e + deviation) + e * line);
      c2 += lever * v * (half * v + line);
      line += Scalar(2) * half * v;
      deviation += Scalar(2) * half * e;
    });
  }
};

}  // namespace fpbm
