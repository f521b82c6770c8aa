#pragma once

#include <Eigen/Core>

namespace fpbm {

/// Most joints that a run-time sized (N = Eigen::Dynamic) arm can have.
inline constexpr int kMaxDof = 32;

/// Rows or columns for which memory is set aside: N itself, or kMaxDof where N is chosen at run time.
template <int N>
inline constexpr int kCapacity = (N == Eigen::Dynamic) ? kMaxDof : N;

/// Matrix that never touches the heap, whatever its size.
/// Unaligned, so that objects holding one may be embedded, copied and passed between translation units
/// built with different vector flags; the processors of today load unaligned memory at full speed.
template <int Rows, int Cols, typename Scalar = double>
using Matrix = Eigen::Matrix<Scalar, Rows, Cols, Eigen::ColMajor | Eigen::DontAlign, kCapacity<Rows>, kCapacity<Cols>>;

/// Column vector that never touches the heap, whatever its size.
template <int N, typename Scalar = double>
using Vector = Matrix<N, 1, Scalar>;

/// Joint state of an arm.
template <int N, typename Scalar = double>
struct State {
  Vector<N, Scalar> q;   ///< Joint positions [rad], or [m] for a prismatic joint.
  Vector<N, Scalar> qd;  ///< Joint velocities [rad/s], or [m/s].
};

}  // namespace fpbm
