#pragma once

#include <Eigen/Core>
#include <limits>

namespace fpbm {

/// The joints that a motion in a null space keeps on their bounds. No more can be held than that space has dimensions;
/// kMost is the most that it may have.
///
/// Z is its basis (joints × dimensions). Keeps Z_heldᵀ = QR of the rows of the joints held, one column for each.
template <int kMost, typename Scalar>
class HeldJoints {
 public:
  /// A joint can be held too where the part of its row of Z outside the held joints' rows is longer than this: about
  /// √epsilon, below which the part is mostly round-off.
  static constexpr Scalar kIndependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-8) : Scalar(3e-4);

  struct Held {
    Eigen::Index joint;
    bool above;  ///< On its upper bound.
  };

  void clear() noexcept { count_ = 0; }
  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const Held& operator[](int i) const noexcept { return held_[i]; }
  [[nodiscard]] bool has(Eigen::Index joint) const noexcept {
    for (int i = 0; i < count_; ++i) {
      if (held_[i].joint == joint) return true;
    }
    return false;
  }

  /// The goal plus the least motion Z y that keeps the held joints at rest.
  template <typename Basis, typename Motion>
  [[nodiscard]] Motion direction(const Basis& Z, const Motion& goal) const noexcept {
    Motion rate = goal;
    if (count_ == 0) return rate;
    Free change(Z.cols());
    for (Eigen::Index k = 0; k < Z.cols(); ++k) change.coeffRef(k) = Scalar(0);
    Free y(count_);
    for (int j = 0; j < count_; ++j) {
      y(j) = -goal(held_[j].joint);
      for (int i = 0; i < j; ++i) y(j) -= R_[i][j] * y(i);
      y(j) /= R_[j][j];
      for (Eigen::Index k = 0; k < Z.cols(); ++k) change.coeffRef(k) += y(j) * Q_[j].coeff(k);
    }
    for (Eigen::Index i = 0; i < Z.rows(); ++i) {
      Scalar sum = Z.coeff(i, 0) * change.coeff(0);
      for (Eigen::Index k = 1; k < Z.cols(); ++k) sum += Z.coeff(i, k) * change.coeff(k);
      rate(i) += sum;
    }
    for (int j = 0; j < count_; ++j) rate(held_[j].joint) = Scalar(0);
    return rate;
  }

  /// Holds one more joint on its bound, or holds it in place of one that may leave its own. False where neither works.
  template <typename Basis>
  [[nodiscard]] bool hold(const Basis& Z, Eigen::Index joint, bool above) noexcept {
    split(Z, joint, count_);
    if (R_[count_][count_] > kIndependent) {
      shorten(Q_[count_], R_[count_][count_]);
      held_[count_++] = {joint, above};
      return true;
    }
    Free share(count_);  // c in Z_joint = Σ c_i Z_held(i).
    int leaving = -1;
    Scalar most = kIndependent;
    for (int i = count_ - 1; i >= 0; --i) {
      share(i) = R_[i][count_];
      for (int j = i + 1; j < count_; ++j) share(i) -= R_[i][j] * share(j);
      share(i) /= R_[i][i];
      const Scalar inward = held_[i].above == above ? share(i) : -share(i);
      if (inward > most) {
        most = inward;
        leaving = i;
      }
    }
    if (leaving < 0) return false;
    held_[leaving] = {joint, above};
    for (int j = leaving; j < count_; ++j) {
      split(Z, held_[j].joint, j);
      shorten(Q_[j], R_[j][j]);
    }
    return true;
  }

 private:
  using Free = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor | Eigen::DontAlign, kMost, 1>;

  /// Z_jointᵀ = Σ R_[i][k] Q_[i] + Q_[k], over i < k: column k, not yet of length 1. Gram and Schmidt, twice, so that Q
  /// is orthogonal where the rest is short.
  template <typename Basis>
  void split(const Basis& Z, Eigen::Index joint, int k) noexcept {
    Q_[k].resize(Z.cols());
    for (Eigen::Index j = 0; j < Z.cols(); ++j) Q_[k].coeffRef(j) = Z.coeff(joint, j);
    for (int i = 0; i < k; ++i) R_[i][k] = Scalar(0);
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < k; ++i) {
        const Scalar along = Q_[i].dot(Q_[k]);
        R_[i][k] += along;
        for (Eigen::Index j = 0; j < Z.cols(); ++j) Q_[k].coeffRef(j) -= along * Q_[i].coeff(j);
      }
    }
    R_[k][k] = Q_[k].norm();
  }

  static void shorten(Free& vector, Scalar length) noexcept {
    for (Eigen::Index k = 0; k < vector.size(); ++k) vector.coeffRef(k) /= length;
  }

  int count_ = 0;
  Held held_[kMost];
  Free Q_[kMost + 1];
  Scalar R_[kMost + 1][kMost + 1];
};

}  // namespace fpbm
