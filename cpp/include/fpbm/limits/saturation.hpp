#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "fpbm/limits/box.hpp"
#include "fpbm/limits/held_joints.hpp"
#include "fpbm/limits/rows.hpp"
#include "fpbm/limits/saturated.hpp"
#include "fpbm/linalg/level_space.hpp"
#include "fpbm/linalg/null_basis.hpp"
#include "fpbm/linalg/self_motion.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// Saturation in the null space (after Flacco, De Luca and Khatib 2012, 2015): the joint motion u within a box that
/// does as much as possible of the desired one,
///
///   J u = J rest + s J (desired − rest),   s ≤ 1 as large as can be,
///
/// where rest is a motion within the box that slows the arm down. Starts from u = rest, s = 0 and raises s. A joint
/// that meets its bound stays there while the others take over, by the null-space motion of least norm in each joint's
/// unit. Where they cannot, a joint that blocks the task is released again (a step of the simplex method); where none
/// does, s is the largest possible, as a linear program finds it. One pass per bound met, 3n at most (random problems
/// take up to 1.7n). u lies in the box and on the task's line after any number of passes.
///
/// Further rows g·u ≤ b, up to P, are as many joints more: each moves by g·u where the others move by u, and has its
/// row gᵀZ of the basis. A row that rest exceeds is widened as far as that.
template <int M, int N, typename Scalar, int P = 0>
class NullSpaceSaturation {
 public:
  using JointVector = Vector<N, Scalar>;

  /// unit: one unit of each joint's motion, such as its bound on acceleration.
  NullSpaceSaturation(const Matrix<M, N, Scalar>& J, const JointVector& unit,
                      const Rows<N, P, Scalar>& rows = {}) noexcept
      : unit_(unit), rows_(rows) {
    const Eigen::Index n = J.cols();
    Eigen::Index all = n;
    if constexpr (P > 0) all += rows.count;
    if (!set_self_motion(J, all)) {
      Matrix<M, N, Scalar> scaled = J;
      for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < J.rows(); ++i) scaled.coeffRef(i, j) *= unit.coeff(j);
      }
      const RowSpace<M, N, Scalar> space(scaled);
      Z_.resize(all, n - space.rank());
      JointVector column = unit;
      for (Eigen::Index j = 0; j < Z_.cols(); ++j) {
        space.column(space.rank() + j, column);
        for (Eigen::Index i = 0; i < n; ++i) Z_.coeffRef(i, j) = column.coeff(i);
      }
    }
    add_rows(n);
  }

  /// Saturation in the null space of task levels, whose rows are in the units of the joints.
  NullSpaceSaturation(const LevelSpace<N, Scalar>& space, const JointVector& unit,
                      const Rows<N, P, Scalar>& rows = {}) noexcept
      : unit_(unit), rows_(rows) {
    const Eigen::Index n = space.size();
    Eigen::Index all = n;
    if constexpr (P > 0) all += rows.count;
    Z_.resize(all, n - space.rank());
    Z_.topRows(n) = space.basis();
    add_rows(n);
  }

  [[nodiscard]] Saturated<N, Scalar> operator()(const Box<N, Scalar>& box, const JointVector& rest,
                                                const JointVector& desired) noexcept {
    using std::abs;
    const Eigen::Index joints = desired.size();
    const Eigen::Index n = Z_.rows();
    All goal(n);
    All upper(n);
    All lower(n);
    for (Eigen::Index i = 0; i < joints; ++i) {
      goal.coeffRef(i) = (desired.coeff(i) - rest.coeff(i)) / unit_.coeff(i);
      upper.coeffRef(i) = (box.upper.coeff(i) - rest.coeff(i)) / unit_.coeff(i);
      lower.coeffRef(i) = (box.lower.coeff(i) - rest.coeff(i)) / unit_.coeff(i);
    }
    if constexpr (P > 0) {
      const Eigen::Index count = n - joints;
      for (Eigen::Index k = 0; k < count; ++k) {
        goal(joints + k) = rows_.change(k, rest, desired);
        upper(joints + k) = std::max(-rows_.excess(k, rest), Scalar(0));
        lower(joints + k) = -std::numeric_limits<Scalar>::infinity();
      }
    }
    All u(n);
    for (Eigen::Index i = 0; i < n; ++i) u.coeffRef(i) = Scalar(0);
    Saturated<N, Scalar> result{rest, Scalar(0), 0, 0};
    held_.clear();
    const Eigen::Index most = kPasses * n;
    while (result.passes < most) {
      ++result.passes;
      const All rate = held_.direction(Z_, goal);
      const Scalar fastest = largest_magnitude(rate);
      if (fastest > Held::kSteepest) break;
      const Scalar still = kStill * fastest;
      Scalar step = Scalar(1) - result.scale;
      Eigen::Index hit = -1;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (!(abs(rate(i)) > still) || held_.has(i)) continue;
        const Scalar reach = ((rate(i) > Scalar(0) ? upper(i) : lower(i)) - u(i)) / rate(i);
        if (reach < step) {
          step = reach > Scalar(0) ? reach : Scalar(0);
          hit = i;
        }
      }
      for (Eigen::Index i = 0; i < n; ++i) u.coeffRef(i) += step * rate.coeff(i);
      result.scale = hit < 0 ? Scalar(1) : result.scale + step;
      if (hit < 0) break;
      const bool above = rate(hit) > Scalar(0);
      u(hit) = above ? upper(hit) : lower(hit);
      const auto round_off = [&]() noexcept {
        Scalar given(0);
        for (Eigen::Index i = 0; i < joints; ++i) {
          given = std::max(given, (abs(desired.coeff(i)) + abs(rest.coeff(i))) / unit_.coeff(i));
        }
        return Held::kRoundOff * (fastest + largest_magnitude(goal)) + kStill * given;
      };
      if (!held_.hold(Z_, hit, above, abs(rate(hit)), Scalar(1) - result.scale, round_off)) {
        count(result, hit, joints);
        break;
      }
    }
    result.u =
        box.nearest(entrywise(rest, [&](Eigen::Index i) { return rest.coeff(i) + unit_.coeff(i) * u.coeff(i); }));
    for (int i = 0; i < held_.count(); ++i) {
      const auto [joint, above] = held_[i];
      count(result, joint, joints);
      if (joint < joints) result.u(joint) = above ? box.upper(joint) : box.lower(joint);
    }
    return result;
  }

 private:
  static constexpr int kAll = P == 0 ? N : Eigen::Dynamic;
  static constexpr int kMost = kCapacity<N>;
  using All = Eigen::Matrix<Scalar, kAll, 1, Eigen::ColMajor | Eigen::DontAlign, kMost + P, 1>;  ///< Joints, then rows.
  using Basis = Eigen::Matrix<Scalar, kAll, Eigen::Dynamic, Eigen::ColMajor | Eigen::DontAlign, kMost + P, kMost>;
  using Held = HeldJoints<kMost, kMost + P, Scalar>;

  /// Share of |v|² from which on v has lost a few digits at most.
  static constexpr Scalar kRegular = Scalar(1e-4);
  static constexpr int kPasses = 3;  ///< At most, for each joint.
  /// A joint is still where its share of the motion is round-off.
  static constexpr Scalar kStill = Scalar(16) * std::numeric_limits<Scalar>::epsilon();

  /// Z of one self-motion v, away from singular postures: v in each joint's unit, at length 1. False elsewhere.
  [[nodiscard]] bool set_self_motion([[maybe_unused]] const Matrix<M, N, Scalar>& J,
                                     [[maybe_unused]] Eigen::Index rows) noexcept {
    if constexpr (kHasSelfMotion<M, N>) {
      SelfMotion<M, N, Scalar> motion;
      for (int kind = 0; kind < motion.kKinds; ++kind) {
        if (!motion.factor(J, kind, kRegular)) continue;
        Z_.resize(rows, 1);
        const JointVector v = motion.null();
        const JointVector in_units = entrywise(v, [&](Eigen::Index i) { return v.coeff(i) / unit_.coeff(i); });
        const Scalar length = norm(in_units);
        for (Eigen::Index i = 0; i < N; ++i) Z_.coeffRef(i, 0) = in_units.coeff(i) / length;
        return true;
      }
    }
    return false;
  }

  /// Appends the rows gᵀZ of the further bounds to the n rows of the joints, each scaled to length 1.
  void add_rows([[maybe_unused]] Eigen::Index n) noexcept {
    if constexpr (P > 0) {
      for (Eigen::Index k = 0; k < rows_.count; ++k) {
        JointVector g = column(rows_.g, k);
        const Scalar length = norm(entrywise(g, [&](Eigen::Index i) { return g.coeff(i) * unit_.coeff(i); }));
        const Scalar scale = length > Scalar(0) ? Scalar(1) / length : Scalar(0);
        g = entrywise(g, [&](Eigen::Index i) { return scale * g.coeff(i); });
        set_column(rows_.g, k, g);
        rows_.b(k) *= scale;
        for (Eigen::Index j = 0; j < Z_.cols(); ++j) {
          Z_(n + k, j) = sum_over(g, [&](Eigen::Index i) { return g.coeff(i) * unit_.coeff(i) * Z_.coeff(i, j); });
        }
      }
    }
  }

  static void count(Saturated<N, Scalar>& result, Eigen::Index held, Eigen::Index joints) noexcept {
    if (held < joints) result.joints |= joint_bit(held);
    if (held >= joints) result.rows |= std::uint32_t(1) << (held - joints);
  }

  Basis Z_;  ///< Basis of the null space, in each joint's unit.
  JointVector unit_;
  Rows<N, P, Scalar> rows_;  ///< Each in a unit of its own.
  Held held_;
};

}  // namespace fpbm
