#pragma once

#include "fpbm/limits/box.hpp"
#include "fpbm/limits/rows.hpp"
#include "fpbm/limits/saturation.hpp"
#include "fpbm/linalg/level_space.hpp"

namespace fpbm {

/// Tasks J_k u = b_k in strict priority, within a box and further rows g·u ≤ b. Level by level, from u₀ = rest:
///
///   d = u_{k−1} + the least motion that the levels before leave free and J_k d = b_k
///   u_k = u_{k−1} + s_k (d − u_{k−1}) + Z_k γ  within the bounds,   s_k ∈ [0, 1] as large as can be,
///
/// where Z_k is a basis of the null space of J₁ … J_k (LevelSpace) and γ moves joints that the bounds leave free in
/// place of those that meet one (NullSpaceSaturation). So u_k keeps every bound that rest keeps; no J_i u of a level
/// before changes, but for round-off; and s_k is the largest that the levels before leave, as a linear program finds
/// it. A task that the levels before contradict is done in the sense of least squares: s_k then refers to that.
template <int N, typename Scalar = double, int P = 0>
class LevelSaturation {
 public:
  using JointVector = Vector<N, Scalar>;

  /// rest: a motion that keeps the box; unit: one unit of each joint's motion, as of NullSpaceSaturation.
  LevelSaturation(const Box<N, Scalar>& box, const JointVector& rest, const JointVector& unit,
                  const Rows<N, P, Scalar>& rows = {}) noexcept
      : box_(box), rows_(rows), unit_(unit), u_(rest), space_(rest.size()) {}

  /// Resolves the next level and returns its scale s. A level that is not finite changes nothing, and its scale is 0.
  template <int M>
  Scalar resolve(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& b) noexcept {
    if (!J.allFinite() || !b.allFinite()) return Scalar(0);
    Matrix<M, N, Scalar> scaled = J;
    for (Eigen::Index j = 0; j < J.cols(); ++j) scaled.col(j) *= unit_(j);
    const Vector<M, Scalar> left = b - J.lazyProduct(u_);
    const JointVector desired = u_ + unit_.cwiseProduct(space_.take(scaled, left));
    if (!desired.allFinite()) return Scalar(0);
    if (box_.contains(desired) && rows_.admit(desired)) {
      u_ = desired;
      return Scalar(1);
    }
    NullSpaceSaturation<Eigen::Dynamic, N, Scalar, P> saturation(space_, unit_, rows_);
    const Saturated<N, Scalar> found = saturation(box_, u_, desired);
    if (!found.u.allFinite()) return Scalar(0);
    u_ = found.u;
    return found.scale;
  }

  /// The motion of the levels so far.
  [[nodiscard]] const JointVector& motion() const noexcept { return u_; }
  /// What they leave free.
  [[nodiscard]] const LevelSpace<N, Scalar>& space() const noexcept { return space_; }

 private:
  Box<N, Scalar> box_;
  Rows<N, P, Scalar> rows_;
  JointVector unit_;
  JointVector u_;
  LevelSpace<N, Scalar> space_;
};

}  // namespace fpbm
