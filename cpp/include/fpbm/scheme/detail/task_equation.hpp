#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/objective/null_space.hpp"

namespace fpbm {

/// Task of a scheme: J u = b for the joint motion u. The referenced matrices must outlive the TaskEquation.
template <int M, int N, typename Scalar = double>
struct TaskEquation {
  const Matrix<M, N, Scalar>& J;
  const Matrix<M, N, Scalar>& Jd;  ///< Time derivative of J [1/s].
  const Vector<M, Scalar>& b;      ///< Commanded velocity, or commanded acceleration less Jd qd.
  const Vector<M, Scalar>& xd;     ///< Reference velocity, for the drift. Not read at velocity level.
};

/// Secondary motion z of a null space in a state, which a solver evaluates if z is not zero.
template <Level kLevel_, int N, typename Scalar>
struct SecondaryMotion {
  static constexpr Level kLevel = kLevel_;
  const NullSpace<N, Scalar>& null_space;
  const State<N, Scalar>& state;

  /// False if z is zero in every state.
  [[nodiscard]] bool active() const noexcept { return null_space.template active<kLevel>(); }
  [[nodiscard]] Vector<N, Scalar> value() const noexcept { return null_space.template at<kLevel>(state); }
};

}  // namespace fpbm
