#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "fpbm/limits/detail/box.hpp"
#include "fpbm/limits/detail/held_joints.hpp"
#include "fpbm/limits/detail/in_units.hpp"
#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/detail/saturated_motion.hpp"
#include "fpbm/linalg/detail/level_space.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Saturation in the null space (Flacco, De Luca and Khatib 2012, 2015; docs/limits.md, Saturation in the null space):
/// the joint motion u within a box that realises as much as possible of a desired motion,
///
///   J u = J rest + s J (desired − rest),   s ≤ 1 as large as possible,
///
/// where `rest` is a braking motion within the box. The algorithm starts from u = rest and s = 0, and raises s. If a
/// joint meets its bound, the joint is held on the bound, and other joints compensate by the null-space motion of least
/// norm in the units of the joints. If no null-space motion can compensate, a joint whose bound blocks the task is
/// released, as in the simplex method. If no joint can be released, s is the optimum of a linear program. Each bound
/// that is met costs one pass. There are at most 3n passes (random problems need up to 1.7n). After every pass, u is in
/// the box and on the line of the task.
///
/// Further rows g·u ≤ b, at most P, are treated as additional joints: the motion of row k is g_k·u, and its row of the
/// basis is g_kᵀZ. If `rest` violates a row, the bound of this row is increased so far that `rest` satisfies the row.
template <int M, int N, typename Scalar, int P = 0>
class NullSpaceSaturation {
 public:
  using JointVector = Vector<N, Scalar>;

  /// unit: unit of each joint's motion, for example its bound on acceleration.
  NullSpaceSaturation(const Matrix<M, N, Scalar>& J, const JointVector& unit,
                      const Rows<N, P, Scalar>& rows = {}) noexcept
      : unit_(unit), rows_(rows) {
    const Eigen::Index n = J.cols();
    Eigen::Index all = n;
    if constexpr (P > 0) all += rows.count;
    set_null_basis(J, unit, all, Z_);
    add_rows(n);
  }

  /// Saturation in the null space of task levels, whose rows are in the units of the joints.
  NullSpaceSaturation(LevelSpace<N, Scalar>& space, const JointVector& unit,
                      const Rows<N, P, Scalar>& rows = {}) noexcept
      : unit_(unit), rows_(rows) {
    const Eigen::Index n = space.size();
    Eigen::Index all = n;
    if constexpr (P > 0) all += rows.count;
    Z_.resize(all, n - space.rank());
    Z_.topRows(n) = space.basis();
    add_rows(n);
  }

  /// Limits the null-space motion that compensates for held joints to a multiple of `desired − rest`
  /// (kLargestCompensation), for a control loop. Then s may be below its optimum if the optimum needs more.
  void limit_compensation() noexcept { compensation_ = kLargestCompensation; }

  [[nodiscard]] SaturatedMotion<N, Scalar> operator()(const Box<N, Scalar>& box, const JointVector& rest,
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
    SaturatedMotion<N, Scalar> result{rest, Scalar(0), 0, 0};
    held_.begin(std::min(Held::kSteepest, compensation_ * largest_magnitude(goal)));
    const Eigen::Index most = kPasses * n;
    while (result.passes < most) {
      ++result.passes;
      const All rate = held_.direction(Z_, goal);
      const Scalar fastest = largest_magnitude(rate);
      if (fastest > held_.steepest()) break;
      const Scalar still = kStill * fastest;
      Scalar step = Scalar(1) - result.scale;
      Eigen::Index hit = -1;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (!(abs(rate(i)) > still) || held_.has(i)) continue;
        const Scalar distance = ((rate(i) > Scalar(0) ? upper(i) : lower(i)) - u(i)) / rate(i);
        if (distance < step) {
          step = distance > Scalar(0) ? distance : Scalar(0);
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

  // `fpbm_tests --gtest_filter='DegenerateSaturation*'` passes with the ranges below.

  /// Largest number of passes for each joint or row. With 2, the tests pass; with 1, 46 of the 16,500 problems are not
  /// solved. `fpbm_tests --gtest_filter='*Saturation*'` prints the largest number of passes.
  static constexpr int kPasses = 3;
  /// Largest null-space motion of limit_compensation(), relative to the largest entry of desired − rest. If a joint on
  /// its bound hardly moves in the null space, the other joints would have to move by whole units to hold back 1e-8 of
  /// a unit, with a sign that changes from tick to tick. StackRest.a_joint_on_its_bound_causes_no_pulses passes with
  /// 1e5 and 1e6, and fails with 1e7. With 1e4, tests of `LevelSaturation*` fail: scales are below their optimum by
  /// more than 1e-6.
  static constexpr Scalar kLargestCompensation = Scalar(1e6);
  /// A rate up to this fraction of the largest rate is round-off error: a joint with a smaller rate does not move.
  /// Range: ε to 1000 ε. With 16,000 ε, a motion leaves the line of the task.
  static constexpr Scalar kStill = Scalar(16) * std::numeric_limits<Scalar>::epsilon();

  /// Appends the rows gᵀZ of the further bounds to the n rows of the joints. Scales each g to length 1 in the units of
  /// the joints.
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

  static void count(SaturatedMotion<N, Scalar>& result, Eigen::Index held, Eigen::Index joints) noexcept {
    if (held < joints) result.joints |= joint_bit(held);
    if (held >= joints) result.rows |= std::uint64_t(1) << (held - joints);
  }

  Basis Z_;  ///< Basis of the null space in the units of the joints.
  JointVector unit_;
  Scalar compensation_ = std::numeric_limits<Scalar>::infinity();
  Rows<N, P, Scalar> rows_;  ///< Scaled to length 1.
  Held held_;
};

}  // namespace fpbm
