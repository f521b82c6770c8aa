#pragma once

#include <Eigen/Core>
#include <limits>
#include <utility>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Squared lengths of what reflections leave of M rows, for the choice of the next pivot (Businger and Golub, "Linear
/// least squares solutions by Householder transformations", 1965).
template <int M, typename Scalar>
class Remainders {
 public:
  explicit Remainders(Eigen::Index rows) noexcept {
    square_.resize(rows);
    computed_.resize(rows);
    inverse_least_.resize(rows);
  }

  /// Row j: its squared length, and that of its remainder.
  void set(Eigen::Index j, Scalar whole, Scalar remainder) noexcept {
    inverse_least_.coeffRef(j) = Scalar(1) / (kDependent * kDependent * whole);
    square_.coeffRef(j) = computed_.coeffRef(j) = remainder;
  }

  /// The row from row `first` on whose remainder is the largest share of the row; −1 if all of them are dependent.
  [[nodiscard]] Eigen::Index largest(Eigen::Index first) const noexcept {
    Eigen::Index row = -1;
    Scalar most(1);
    for (Eigen::Index j = first; j < square_.size(); ++j) {
      const Scalar share = square_.coeff(j) * inverse_least_.coeff(j);
      if (!(share > most)) continue;
      most = share;
      row = j;
    }
    return row;
  }

  void swap(Eigen::Index i, Eigen::Index j) noexcept {
    std::swap(square_.coeffRef(i), square_.coeffRef(j));
    std::swap(computed_.coeffRef(i), computed_.coeffRef(j));
    std::swap(inverse_least_.coeffRef(i), inverse_least_.coeffRef(j));
  }

  /// Removes an entry from the remainder of row j. measured() computes the squared length of what is left.
  template <typename Measured>
  void remove(Eigen::Index j, Scalar entry, const Measured& measured) noexcept {
    square_.coeffRef(j) -= entry * entry;
    if (square_.coeff(j) < kCancelled * computed_.coeff(j)) square_.coeffRef(j) = computed_.coeffRef(j) = measured();
  }

 private:
  /// Remainder of a dependent row, as a share of its length. It is round-off error, 1e-16 times the condition number of
  /// the higher levels; a motion along a remainder of 1e-9 already amplifies that error to 1e-7.
  static constexpr Scalar kDependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-4);

  /// Share of a squared length below which its differences have lost 3 of 16 digits.
  static constexpr Scalar kCancelled = Scalar(1e-3);

  Vector<M, Scalar> square_;
  Vector<M, Scalar> computed_;  ///< The square when it was last computed from the entries.
  Vector<M, Scalar> inverse_least_;
};

}  // namespace fpbm
