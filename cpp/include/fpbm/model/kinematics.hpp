#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Kinematics of an arm in one state: all that a scheme knows about the robot.
///
/// Filled by an arm of model/, or by any other library that computes these three.
template <typename Space, int N, typename Scalar = double>
struct Kinematics {
  static constexpr int kRows = Space::kRows;

  typename Space::template Point<Scalar> tip;  ///< f(q), in the base frame [m, rad].
  Matrix<kRows, N, Scalar> J;                  ///< Task Jacobian: tip velocity is J qd.
  Matrix<kRows, N, Scalar> Jd;                 ///< dJ/dt along qd: tip acceleration is J qdd + Jd qd.
};

}  // namespace fpbm
