#pragma once

#include <Eigen/Core>
#include <limits>
#include <utility>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Squared lengths of the remainders of M rows, for the choice of the next pivot (Businger and Golub, "Linear least
/// squares solutions by Householder transformations", 1965). The remainder of a row is the row minus its projection on
/// all pivot rows so far.
template <int M, typename Scalar>
class Remainders {
 public:
  explicit Remainders(Eigen::Index rows) noexcept {
    square_.resize(rows);
    computed_.resize(rows);
    inverse_least_.resize(rows);
  }

  /// Sets the squared length of row j and the squared length of its remainder.
  void set(Eigen::Index j, Scalar whole, Scalar remainder) noexcept {
    inverse_least_.coeffRef(j) = Scalar(1) / (kDependent * kDependent * whole);
    square_.coeffRef(j) = computed_.coeffRef(j) = remainder;
  }

  /// Row j ≥ first with the largest ratio of remainder to whole row, or −1 if all these rows are dependent.
  [[nodiscard]] Eigen::Index largest(Eigen::Index first) const noexcept {
    Eigen::Index row = -1;
    Scalar most(1);
    for (Eigen::Index j = first; j < square_.size(); ++j) {
      const Scalar ratio = square_.coeff(j) * inverse_least_.coeff(j);
      if (!(ratio > most)) continue;
      most = ratio;
      row = j;
    }
    return row;
  }

  void swap(Eigen::Index i, Eigen::Index j) noexcept {
    std::swap(square_.coeffRef(i), square_.coeffRef(j));
    std::swap(computed_.coeffRef(i), computed_.coeffRef(j));
    std::swap(inverse_least_.coeffRef(i), inverse_least_.coeffRef(j));
  }

  /// Removes an entry from the remainder of row j. measured() computes the squared length of the new remainder.
  template <typename Measured>
  void remove(Eigen::Index j, Scalar entry, const Measured& measured) noexcept {
    square_.coeffRef(j) -= entry * entry;
    if (square_.coeff(j) < kCancelled * computed_.coeff(j)) square_.coeffRef(j) = computed_.coeffRef(j) = measured();
  }

 private:
  /// Largest remainder of a dependent row, as a fraction of the length of the row. The remainder of a dependent row is
  /// round-off error, 1e-16 times the condition number of the higher levels. A motion along a remainder of 1e-9 already
  /// amplifies the round-off error to 1e-7. Factors of 0.01 to 10 pass `LevelSpace.*`.
  static constexpr Scalar kDependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-4);

  /// Fraction of a squared length below which a difference of squares has lost 3 of 16 digits. With 1e-9,
  /// `LevelSpace.*` fails; 1e-4 to 1 pass.
  static constexpr Scalar kCancelled = Scalar(1e-3);

  Vector<M, Scalar> square_;
  Vector<M, Scalar> computed_;  ///< Last value of square_ that was computed from the entries.
  Vector<M, Scalar> inverse_least_;
};

}  // namespace fpbm
