#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fpbm/linalg/detail/column_sums.hpp"

namespace fpbm {

/// Joints that a null-space motion keeps on their bounds. The number of held joints is at most the dimension of the
/// null space. kMost: largest dimension of the null space. kEntries: largest number of rows of the basis Z.
///
/// Stores the factorisation Z_heldᵀ = QR, where Z_held are the rows of Z of the held joints, one column of Z_heldᵀ for
/// each held joint. u is the joint motion in the units of the joints, and s the task scale (NullSpaceSaturation).
template <int kMost, int kEntries, typename Scalar>
class HeldJoints {
 public:
  // In double, `fpbm_tests --gtest_filter='DegenerateSaturation*'` passes with the ranges below.

  static constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();
  /// Smallest length of the independent part of a joint's row of Z, for a joint that is held in addition: about √ε. The
  /// independent part is orthogonal to the rows of the held joints. A shorter part is mostly round-off error. A slow
  /// joint may be held with a shorter part if (ε/part)(rate/part) ≤ 1: ε/part is the round-off error of the direction
  /// of the part, and rate/part is the motion. Range: 1e-10 to 1e-6.
  static constexpr Scalar kIndependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-8) : Scalar(3e-4);

  /// A joint with a shorter independent part does not move in the null space: this part is the round-off error of a
  /// basis of unit length, about ε for each of the at most 64 joints. Without this threshold, holding a joint against a
  /// motion of 1e-13 would move other joints to their bounds
  /// (DegenerateSaturation.round_off_error_of_the_basis_moves_no_joint). Range: 64 ε to 640 ε.
  static constexpr Scalar kIdle = Scalar(64) * kEpsilon;

  /// Round-off error of Z. The basis of SelfMotion has an error of 5e-13 if the condition number of J is 1e3. Range:
  /// 1e-13 to 1e-12. With 1e-14, a task scale is 0.1 too small; with 1e-11, motions leave the line of the task.
  static constexpr Scalar kRoundOff = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-12) : Scalar(3e-5);
  /// Largest factor by which the held joints may amplify a round-off error. With this factor, at most 1e-10 of the
  /// motion deviates from the line of the task. Range: 1 to 1000. With 1e5, a motion leaves the line of the task.
  static constexpr Scalar kAmplified = Scalar(100);
  /// du/ds above which a step is mostly round-off error: if the step moves a joint by a whole unit, s increases by
  /// almost nothing. Range: 1e7 to 1e14.
  static constexpr Scalar kSteepest = Scalar(100) / kIndependent;

  struct Held {
    Eigen::Index joint;
    bool above;  ///< Whether the joint is on its upper bound.
  };

  /// Releases all joints. steepest: largest entry of direction() with which a joint may be held, at most kSteepest.
  void begin(Scalar steepest) noexcept {
    count_ = 0;
    solved_ = 0;
    fixed_.reset();
    steepest_ = steepest;
  }
  [[nodiscard]] Scalar steepest() const noexcept { return steepest_; }
  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const Held& operator[](int i) const noexcept { return held_[i]; }
  /// Whether a joint is held, or does not move because of the held joints.
  [[nodiscard]] bool has(Eigen::Index joint) const noexcept { return fixed_[index(joint)]; }

  /// du/ds: the goal plus the least-norm null-space motion Z Q y for which the held joints do not move. `goal` must be
  /// the same for all joints that are held after begin(), so that y keeps its entries when a joint is added.
  template <typename Basis, typename Motion>
  [[nodiscard]] Motion direction(const Basis& Z, const Motion& goal) noexcept {
    Motion rate = goal;
    if (count_ == 0) return rate;
    const Eigen::Index dimensions = Z.cols();
    if (solved_ == 0) change_ = filled<Free>(dimensions);
    for (; solved_ < count_; ++solved_) {
      const int j = solved_;
      y_[j] = -goal(held_[j].joint);
      for (int i = 0; i < j; ++i) y_[j] -= R_[i][j] * y_[i];
      y_[j] /= R_[j][j];
      subtract_multiple(change_.data(), -y_[j], Q_[j].data(), dimensions);
    }
    const auto rows = extent<Motion::RowsAtCompileTime>(Z.rows());
    for (Eigen::Index k = 0; k < dimensions; ++k) {
      if (change_.coeff(k) == Scalar(0)) continue;  // A column of joints that are independent of the held joints.
      subtract_multiple(rate.data(), -change_.coeff(k), Z.data() + k * rows, rows);
    }
    for (int j = 0; j < count_; ++j) rate(held_[j].joint) = Scalar(0);
    return rate;
  }

  /// Holds a joint on its bound, in addition to the held joints or instead of a held joint that can leave its bound. If
  /// the joint depends on the held joints and its remaining motion is round-off error, the joint does not need to be
  /// held. In all other cases, returns false.
  ///
  /// above: whether the joint is on its upper bound. rate: |du/ds| of the joint. remaining: 1 − s. round_off():
  /// round-off error of the motions of independent joints.
  template <typename Basis, typename RoundOff>
  [[nodiscard]] bool hold(const Basis& Z, Eigen::Index joint, bool above, Scalar rate, Scalar remaining,
                          RoundOff&& round_off) noexcept {
    split(Z, joint, count_);
    const Scalar outside = R_[count_][count_];
    const bool is_free = count_ < Z.cols() && rate <= steepest_ * outside;
    if (is_free && outside > kIndependent) return add(joint, above);
    const Free c = coefficients();
    Scalar amplified(1);
    for (int i = 0; i < count_; ++i) amplified += std::abs(c.coeff(i));
    if (rate * remaining <= round_off() * std::min(amplified, kAmplified)) {
      fixed_[index(joint)] = true;
      return true;
    }
    if (is_free && outside > kIdle && outside <= kIndependent && rate <= outside * outside / kEpsilon) {
      return add(joint, above);
    }
    // With a smaller coefficient, the released joint would leave its bound at a rate above steepest_.
    return replace(Z, joint, above, c, std::max(kRoundOff, rate / steepest_));
  }

 private:
  using Free = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor | Eigen::DontAlign, kMost, 1>;

  [[nodiscard]] static std::size_t index(Eigen::Index joint) noexcept { return static_cast<std::size_t>(joint); }

  /// c in Z_joint = Σ c_i Z_held(i), for the joint of the last split().
  [[nodiscard]] Free coefficients() const noexcept {
    Free c(count_);
    for (int i = count_ - 1; i >= 0; --i) {
      c(i) = R_[i][count_];
      for (int j = i + 1; j < count_; ++j) c(i) -= R_[i][j] * c(j);
      c(i) /= R_[i][i];
    }
    return c;
  }

  /// Holds a joint instead of the held joint that leaves its bound fastest. If the coefficient of this held joint is
  /// not above `least`, returns false.
  template <typename Basis>
  [[nodiscard]] bool replace(const Basis& Z, Eigen::Index joint, bool above, const Free& c, Scalar least) noexcept {
    int leaving = -1;
    for (int i = count_ - 1; i >= 0; --i) {
      const Scalar inward = held_[i].above == above ? c(i) : -c(i);
      if (inward > least) {
        least = inward;
        leaving = i;
      }
    }
    if (leaving < 0) return false;
    held_[leaving] = {joint, above};
    solved_ = 0;
    for (int j = leaving; j < count_; ++j) {
      split(Z, held_[j].joint, j);
      divide(Q_[j], R_[j][j]);
    }
    find_fixed();
    return true;
  }

  /// Holds the joint of the last split().
  bool add(Eigen::Index joint, bool above) noexcept {
    divide(Q_[count_], R_[count_][count_]);
    held_[count_++] = {joint, above};
    find_fixed();
    return true;
  }

  void find_fixed() noexcept {
    fixed_.reset();
    for (int i = 0; i < count_; ++i) fixed_[index(held_[i].joint)] = true;
  }

  /// Column k of the factorisation, not yet normalised: Z_jointᵀ = Σ R_[i][k] Q_[i] + Q_[k], over i < k. Two rounds of
  /// Gram-Schmidt keep Q orthogonal even if Q_[k] is short.
  template <typename Basis>
  void split(const Basis& Z, Eigen::Index joint, int k) noexcept {
    Q_[k].resize(Z.cols());
    for (Eigen::Index j = 0; j < Z.cols(); ++j) Q_[k].coeffRef(j) = Z.coeff(joint, j);
    for (int i = 0; i < k; ++i) R_[i][k] = Scalar(0);
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < k; ++i) {
        const Scalar along = column_dot(Q_[i].data(), Q_[k].data(), Z.cols());
        R_[i][k] += along;
        subtract_multiple(Q_[k].data(), along, Q_[i].data(), Z.cols());
      }
    }
    R_[k][k] = std::sqrt(squared_length(Q_[k].data(), Z.cols()));
  }

  static void divide(Free& vector, Scalar length) noexcept {
    for (Eigen::Index k = 0; k < vector.size(); ++k) vector.coeffRef(k) /= length;
  }

  Scalar steepest_ = kSteepest;
  int count_ = 0;
  int solved_ = 0;  ///< Number of held joints that y_ and change_ = Q y include.
  Scalar y_[kMost];
  Free change_;
  std::bitset<kEntries> fixed_;  ///< Bit i is has(i).
  Held held_[kMost];
  Free Q_[kMost + 1];
  Scalar R_[kMost + 1][kMost + 1];
};

}  // namespace fpbm
