#pragma once

#include <cstdint>
#include <limits>

#include "fpbm/limits/box.hpp"
#include "fpbm/linalg/null_basis.hpp"

namespace fpbm {

/// A joint motion within a box.
template <int N, typename Scalar = double>
struct Saturated {
  Vector<N, Scalar> u;
  Scalar scale;          ///< s: share of the task that is left, 1 for all of it.
  std::uint32_t joints;  ///< Bit i is set where joint i is on its bound.
  int passes;            ///< Number of passes; 0 where the desired motion lies in the box.
};

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
template <int M, int N, typename Scalar>
class NullSpaceSaturation {
 public:
  using JointVector = Vector<N, Scalar>;

  /// unit: one unit of each joint's motion, such as its bound on acceleration.
  NullSpaceSaturation(const Matrix<M, N, Scalar>& J, const JointVector& unit) noexcept : unit_(unit) {
    const RowSpace<M, N, Scalar> rows(J * unit.asDiagonal());
    Z_.resize(J.cols(), J.cols() - rows.rank());
    for (Eigen::Index j = 0; j < Z_.cols(); ++j) rows.column(rows.rank() + j, Z_.col(j));
  }

  [[nodiscard]] Saturated<N, Scalar> operator()(const Box<N, Scalar>& box, const JointVector& rest,
                                                const JointVector& desired) noexcept {
    using std::abs;
    const Eigen::Index n = desired.size();
    const JointVector goal = (desired - rest).cwiseQuotient(unit_);
    const JointVector upper = (box.upper - rest).cwiseQuotient(unit_);
    const JointVector lower = (box.lower - rest).cwiseQuotient(unit_);
    Saturated<N, Scalar> result{JointVector::Zero(n), Scalar(0), 0, 0};
    JointVector& u = result.u;
    count_ = 0;
    const Eigen::Index most = kPasses * n;
    while (result.passes < most) {
      ++result.passes;
      const JointVector rate = direction(goal);
      const Scalar fastest = rate.cwiseAbs().maxCoeff();
      if (fastest > kSteepest) break;
      const Scalar still = kStill * fastest;
      Scalar step = Scalar(1) - result.scale;
      Eigen::Index hit = -1;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (!(abs(rate(i)) > still) || active(i)) continue;
        const Scalar reach = ((rate(i) > Scalar(0) ? upper(i) : lower(i)) - u(i)) / rate(i);
        if (reach < step) {
          step = reach > Scalar(0) ? reach : Scalar(0);
          hit = i;
        }
      }
      u += step * rate;
      result.scale = hit < 0 ? Scalar(1) : result.scale + step;
      if (hit < 0) break;
      const bool above = rate(hit) > Scalar(0);
      u(hit) = above ? upper(hit) : lower(hit);
      if (!hold(hit, above)) {
        result.joints |= bit(hit);
        break;
      }
    }
    for (int i = 0; i < count_; ++i) result.joints |= bit(held_[i]);
    u = box.nearest(rest + unit_.cwiseProduct(u));
    for (int i = 0; i < count_; ++i) u(held_[i]) = above_[i] ? box.upper(held_[i]) : box.lower(held_[i]);
    return result;
  }

 private:
  static constexpr int kMost = kCapacity<N>;
  using Basis = Eigen::Matrix<Scalar, N, Eigen::Dynamic, Eigen::ColMajor | Eigen::DontAlign, kMost, kMost>;
  using Free = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor | Eigen::DontAlign, kMost, 1>;

  static constexpr int kPasses = 3;  ///< At most, for each joint.
  /// A joint is still where its share of the motion is round-off.
  static constexpr Scalar kStill = Scalar(16) * std::numeric_limits<Scalar>::epsilon();
  /// A joint can be held too where the part of its row of Z outside the held joints' rows is longer than this: about
  /// √epsilon, below which the part is mostly round-off.
  static constexpr Scalar kIndependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-8) : Scalar(3e-4);
  /// du/ds beyond which a step is mostly round-off, and gains next to nothing for a motion of a whole unit.
  static constexpr Scalar kSteepest = Scalar(100) / kIndependent;

  [[nodiscard]] static std::uint32_t bit(Eigen::Index joint) noexcept { return std::uint32_t(1) << joint; }

  [[nodiscard]] bool active(Eigen::Index joint) const noexcept {
    for (int i = 0; i < count_; ++i) {
      if (held_[i] == joint) return true;
    }
    return false;
  }

  /// du/ds: the goal plus the least null-space motion that keeps the held joints at rest.
  [[nodiscard]] JointVector direction(const JointVector& goal) const noexcept {
    JointVector rate = goal;
    if (count_ == 0) return rate;
    Free change = Free::Zero(Z_.cols());
    Free y(count_);
    for (int j = 0; j < count_; ++j) {
      y(j) = -goal(held_[j]);
      for (int i = 0; i < j; ++i) y(j) -= R_[i][j] * y(i);
      y(j) /= R_[j][j];
      change += y(j) * Q_[j];
    }
    rate += Z_.lazyProduct(change);
    for (int j = 0; j < count_; ++j) rate(held_[j]) = Scalar(0);
    return rate;
  }

  /// Z_jointᵀ = Σ R_[i][k] Q_[i] + Q_[k], over i < k: one column more of Z_heldᵀ = QR, not yet of length 1. Gram and
  /// Schmidt, twice, so that Q is orthogonal where the rest is short.
  void split(Eigen::Index joint, int k) noexcept {
    Q_[k] = Z_.row(joint).transpose();
    for (int i = 0; i < k; ++i) R_[i][k] = Scalar(0);
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < k; ++i) {
        const Scalar along = Q_[i].dot(Q_[k]);
        R_[i][k] += along;
        Q_[k] -= along * Q_[i];
      }
    }
    R_[k][k] = Q_[k].norm();
  }

  /// Holds one more joint on its bound, or holds it in place of one that may leave its own. False where neither works.
  [[nodiscard]] bool hold(Eigen::Index joint, bool above) noexcept {
    split(joint, count_);
    if (R_[count_][count_] > kIndependent) {
      Q_[count_] /= R_[count_][count_];
      held_[count_] = joint;
      above_[count_] = above;
      ++count_;
      return true;
    }
    Free share(count_);  // c in Z_joint = Σ c_i Z_held(i).
    int leaving = -1;
    Scalar most = kIndependent;
    for (int i = count_ - 1; i >= 0; --i) {
      share(i) = R_[i][count_];
      for (int j = i + 1; j < count_; ++j) share(i) -= R_[i][j] * share(j);
      share(i) /= R_[i][i];
      const Scalar inward = above_[i] == above ? share(i) : -share(i);
      if (inward > most) {
        most = inward;
        leaving = i;
      }
    }
    if (leaving < 0) return false;
    held_[leaving] = joint;
    above_[leaving] = above;
    for (int j = leaving; j < count_; ++j) {
      split(held_[j], j);
      Q_[j] /= R_[j][j];
    }
    return true;
  }

  Basis Z_;  ///< Basis of the null space, in each joint's unit.
  JointVector unit_;
  int count_ = 0;
  Eigen::Index held_[kMost];
  bool above_[kMost];
  Free Q_[kMost + 1];  ///< Z_heldᵀ = QR, one column per held joint.
  Scalar R_[kMost + 1][kMost + 1];
};

}  // namespace fpbm
