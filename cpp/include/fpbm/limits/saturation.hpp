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
/// does, s is the largest possible. One pass per bound met, n at most. u lies in the box after any number of passes.
template <int M, int N, typename Scalar>
class NullSpaceSaturation {
 public:
  using JointVector = Vector<N, Scalar>;
  static constexpr int kFree = kNullity<M, N>;

  /// unit: one unit of each joint's motion, such as its bound on acceleration.
  NullSpaceSaturation(const Matrix<M, N, Scalar>& J, const JointVector& unit) noexcept
      : Z_(null_basis<M, N, Scalar>(J * unit.asDiagonal())),
        unit_(unit),
        Q_(Z_.cols(), Z_.cols()),
        R_(Z_.cols(), Z_.cols()) {}

  [[nodiscard]] Saturated<N, Scalar> operator()(const Box<N, Scalar>& box, const JointVector& rest,
                                                const JointVector& desired) noexcept {
    const Eigen::Index n = desired.size();
    const JointVector goal = (desired - rest).cwiseQuotient(unit_);
    const JointVector upper = (box.upper - rest).cwiseQuotient(unit_);
    const JointVector lower = (box.lower - rest).cwiseQuotient(unit_);
    Saturated<N, Scalar> result{JointVector::Zero(n), Scalar(0), 0, 0};
    JointVector& u = result.u;
    count_ = 0;
    while (result.passes < n) {
      ++result.passes;
      orthogonalise();
      const JointVector rate = direction(goal);
      Scalar step = Scalar(1) - result.scale;
      Eigen::Index hit = -1;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (active(i) || rate(i) == Scalar(0)) continue;
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
    for (int i = 0; i < count(); ++i) result.joints |= bit(held_[i]);
    u = box.nearest(rest + unit_.cwiseProduct(u));
    for (int i = 0; i < count(); ++i) u(held_[i]) = above_[i] ? box.upper(held_[i]) : box.lower(held_[i]);
    return result;
  }

 private:
  using Free = Vector<kFree, Scalar>;
  using Square = Matrix<kFree, kFree, Scalar>;
  static constexpr int kMost = kFree == Eigen::Dynamic ? kMaxDof : (kFree > 0 ? kFree : 1);
  /// A joint can be held too where the part of its row of Z outside the held joints' rows has at least this square.
  static constexpr Scalar kIndependent = Scalar(1e-4);

  [[nodiscard]] static std::uint32_t bit(Eigen::Index joint) noexcept { return std::uint32_t(1) << joint; }

  /// Number of joints held, never more than kMost (which the compiler cannot know).
  [[nodiscard]] int count() const noexcept { return count_ < kMost ? count_ : kMost; }

  [[nodiscard]] bool active(Eigen::Index joint) const noexcept {
    for (int i = 0; i < count(); ++i) {
      if (held_[i] == joint) return true;
    }
    return false;
  }

  /// Z_heldᵀ = QR by Gram and Schmidt.
  void orthogonalise() noexcept {
    using std::sqrt;
    for (int j = 0; j < count(); ++j) {
      Free column = Z_.row(held_[j]).transpose();
      for (int i = 0; i < j; ++i) {
        R_(i, j) = Q_.col(i).dot(column);
        column -= R_(i, j) * Q_.col(i);
      }
      R_(j, j) = column.norm();
      Q_.col(j) = column / R_(j, j);
    }
  }

  /// du/ds: the goal plus the least null-space motion that keeps the held joints at rest.
  [[nodiscard]] JointVector direction(const JointVector& goal) const noexcept {
    JointVector rate = goal;
    if (count_ == 0) return rate;
    Free change = Free::Zero(Z_.cols());
    Free y(Z_.cols());
    for (int j = 0; j < count(); ++j) {
      y(j) = -goal(held_[j]);
      for (int i = 0; i < j; ++i) y(j) -= R_(i, j) * y(i);
      y(j) /= R_(j, j);
      change += y(j) * Q_.col(j);
    }
    rate += Z_.lazyProduct(change);
    for (int j = 0; j < count(); ++j) rate(held_[j]) = Scalar(0);
    return rate;
  }

  /// Holds one more joint on its bound, or holds it in place of one that may leave its own. False where neither works.
  [[nodiscard]] bool hold(Eigen::Index joint, bool above) noexcept {
    Free rest = Z_.row(joint).transpose();
    Free share(Z_.cols());  // Becomes c in Z_joint = Σ c_i Z_held(i) + rest.
    for (int i = 0; i < count(); ++i) {
      share(i) = Q_.col(i).dot(rest);
      rest -= share(i) * Q_.col(i);
    }
    if (count_ < Z_.cols() && rest.squaredNorm() > kIndependent) {
      held_[count_] = joint;
      above_[count_] = above;
      ++count_;
      return true;
    }
    for (int i = count() - 1; i >= 0; --i) {
      for (int j = i + 1; j < count(); ++j) share(i) -= R_(i, j) * share(j);
      share(i) /= R_(i, i);
    }
    int leaving = -1;
    Scalar most = std::numeric_limits<Scalar>::epsilon();
    for (int i = 0; i < count(); ++i) {
      const Scalar inward = above_[i] == above ? share(i) : -share(i);
      if (inward > most) {
        most = inward;
        leaving = i;
      }
    }
    if (leaving < 0) return false;
    held_[leaving] = joint;
    above_[leaving] = above;
    return true;
  }

  Matrix<N, kFree, Scalar> Z_;  ///< Basis of the null space, in each joint's unit.
  const JointVector& unit_;
  int count_ = 0;
  Eigen::Index held_[kMost];
  bool above_[kMost];
  Square Q_;  ///< Z_heldᵀ = QR, one column per held joint.
  Square R_;
};

}  // namespace fpbm
