#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fpbm/linalg/paired.hpp"

namespace fpbm {

/// The joints that a motion in a null space keeps on their bounds. No more can be held than that space has dimensions;
/// kMost is the most that it may have; kEntries is the number of rows of its basis Z at most.
///
/// Keeps Z_heldᵀ = QR of the rows of the joints held, one column for each.
template <int kMost, int kEntries, typename Scalar>
class HeldJoints {
 public:
  static constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();
  /// A joint can be held too where the part of its row of Z outside the held joints' rows is longer than this: about
  /// √epsilon, below which the part is mostly round-off.
  /// A shorter part serves a slow joint: round-off error in its direction, ε/part, times the motion, rate/part, is then
  /// less than 1.
  static constexpr Scalar kIndependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-8) : Scalar(3e-4);

  /// A joint whose part is shorter does not move in the null space: the part is the round-off error of a basis of
  /// unit length. Otherwise, to hold a joint against a motion of 1e-13, other joints would move up to their bounds.
  static constexpr Scalar kIdle = Scalar(64) * kEpsilon;

  /// Round-off error of Z: SelfMotion's is 5e-13 where J has a condition of 1e3.
  static constexpr Scalar kRoundOff = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-12) : Scalar(3e-5);
  /// The most that held joints may amplify a round-off error by, so that 1e-10 of the motion is off the task's line at
  /// most.
  static constexpr Scalar kAmplified = Scalar(100);
  /// du/ds beyond which a step is mostly round-off, and gains next to nothing for a motion of a whole unit.
  static constexpr Scalar kSteepest = Scalar(100) / kIndependent;

  struct Held {
    Eigen::Index joint;
    bool above;  ///< On its upper bound.
  };

  void clear() noexcept {
    count_ = 0;
    solved_ = 0;
    fixed_.reset();
  }
  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const Held& operator[](int i) const noexcept { return held_[i]; }
  /// Whether a joint is held, or rests because the held joints do.
  [[nodiscard]] bool has(Eigen::Index joint) const noexcept { return fixed_[index(joint)]; }

  /// The goal plus the least motion Z Q y that keeps the held joints at rest. goal: the same for all joints that are
  /// held since clear(), so that y keeps its entries when a joint is added.
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
      subtract_multiple(rate.data(), -change_.coeff(k), Z.data() + k * rows, rows);
    }
    for (int j = 0; j < count_; ++j) rate(held_[j].joint) = Scalar(0);
    return rate;
  }

  /// Holds one more joint on its bound, or holds it in place of one that may leave its own. False where neither works.
  ///
  /// rate: of the joint; remaining: increase of s up to 1; round_off(): of the motions of independent joints. A joint
  /// that depends on those held and whose remaining motion is round-off error needs no hold.
  template <typename Basis, typename RoundOff>
  [[nodiscard]] bool hold(const Basis& Z, Eigen::Index joint, bool above, Scalar rate, Scalar remaining,
                          RoundOff&& round_off) noexcept {
    split(Z, joint, count_);
    const Scalar outside = R_[count_][count_];
    const bool spare = count_ < Z.cols();
    if (spare && outside > kIndependent && rate <= kSteepest * outside) return add(joint, above);
    const Free share = shares();
    Scalar amplified(1);
    for (int i = 0; i < count_; ++i) amplified += std::abs(share.coeff(i));
    if (rate * remaining <= round_off() * std::min(amplified, kAmplified)) {
      fixed_[index(joint)] = true;
      return true;
    }
    if (spare && outside > kIdle && outside <= kIndependent && rate <= outside * outside / kEpsilon) {
      return add(joint, above);
    }
    // A smaller share would let the other joint leave at a rate beyond kSteepest.
    return replace(Z, joint, above, share, std::max(kRoundOff, rate / kSteepest));
  }

 private:
  using Free = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor | Eigen::DontAlign, kMost, 1>;

  [[nodiscard]] static std::size_t index(Eigen::Index joint) noexcept { return static_cast<std::size_t>(joint); }

  /// c in Z_joint = Σ c_i Z_held(i), of the joint that was split last.
  [[nodiscard]] Free shares() const noexcept {
    Free share(count_);
    for (int i = count_ - 1; i >= 0; --i) {
      share(i) = R_[i][count_];
      for (int j = i + 1; j < count_; ++j) share(i) -= R_[i][j] * share(j);
      share(i) /= R_[i][i];
    }
    return share;
  }

  /// Holds a joint in place of the one that leaves its bound fastest, if its share is more than a least one.
  template <typename Basis>
  [[nodiscard]] bool replace(const Basis& Z, Eigen::Index joint, bool above, const Free& share, Scalar least) noexcept {
    int leaving = -1;
    for (int i = count_ - 1; i >= 0; --i) {
      const Scalar inward = held_[i].above == above ? share(i) : -share(i);
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
      shorten(Q_[j], R_[j][j]);
    }
    find_fixed();
    return true;
  }

  /// Holds the joint that was split last.
  bool add(Eigen::Index joint, bool above) noexcept {
    shorten(Q_[count_], R_[count_][count_]);
    held_[count_++] = {joint, above};
    find_fixed();
    return true;
  }

  void find_fixed() noexcept {
    fixed_.reset();
    for (int i = 0; i < count_; ++i) fixed_[index(held_[i].joint)] = true;
  }

  /// Z_jointᵀ = Σ R_[i][k] Q_[i] + Q_[k], over i < k: column k, not yet of length 1. Gram and Schmidt, twice, so that Q
  /// is orthogonal where the rest is short.
  template <typename Basis>
  void split(const Basis& Z, Eigen::Index joint, int k) noexcept {
    Q_[k].resize(Z.cols());
    for (Eigen::Index j = 0; j < Z.cols(); ++j) Q_[k].coeffRef(j) = Z.coeff(joint, j);
    for (int i = 0; i < k; ++i) R_[i][k] = Scalar(0);
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < k; ++i) {
        const Scalar along = paired_dot(Q_[i].data(), Q_[k].data(), Z.cols());
        R_[i][k] += along;
        subtract_multiple(Q_[k].data(), along, Q_[i].data(), Z.cols());
      }
    }
    R_[k][k] = std::sqrt(squared_length(Q_[k].data(), Z.cols()));
  }

  static void shorten(Free& vector, Scalar length) noexcept {
    for (Eigen::Index k = 0; k < vector.size(); ++k) vector.coeffRef(k) /= length;
  }

  int count_ = 0;
  int solved_ = 0;  ///< Number of joints that y and change_ = Q y have.
  Scalar y_[kMost];
  Free change_;
  std::bitset<kEntries> fixed_;  ///< Bit i is set where has(i).
  Held held_[kMost];
  Free Q_[kMost + 1];
  Scalar R_[kMost + 1][kMost + 1];
};

}  // namespace fpbm
