#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "fpbm/core/detail/float_model.hpp"

namespace fpbm {

/// Output of a scheme: joint velocities or joint accelerations.
enum class Level : unsigned char { kVelocity, kAcceleration };

/// Largest number of joints of an arm whose number of joints is known at run time (N = Eigen::Dynamic): the number of
/// bits of JointBits.
inline constexpr int kMaxDof = 64;

/// Number of rows or columns for which memory is reserved: N, or kMaxDof if N is Eigen::Dynamic.
template <int N>
inline constexpr int kCapacity = (N == Eigen::Dynamic) ? kMaxDof : N;

/// One bit per joint: bit i belongs to joint i.
using JointBits = std::uint64_t;
[[nodiscard]] constexpr JointBits joint_bit(Eigen::Index i) noexcept {
  return JointBits(1) << i;
}
/// Calls f(k) for each joint whose bit is set, from the base to the tip.
template <typename F>
[[gnu::always_inline]] inline void each_joint(JointBits bits, const F& f) noexcept {
  for (Eigen::Index k = 0; bits != 0; ++k, bits >>= 1U) {
    if ((bits & 1U) != 0) f(k);
  }
}

/// Matrix of any size without heap allocation.
/// Unaligned, so that objects with matrices may be embedded, copied and passed between translation units that are
/// compiled with different SIMD flags. Current processors load unaligned memory at full speed.
template <int Rows, int Cols, typename Scalar = double>
using Matrix =
    Eigen::Matrix<Scalar, Rows, Cols, (Rows == 1 && Cols != 1 ? Eigen::RowMajor : Eigen::ColMajor) | Eigen::DontAlign,
                  kCapacity<Rows>, kCapacity<Cols>>;

/// Column vector of any size without heap allocation.
template <int N, typename Scalar = double>
using Vector = Matrix<N, 1, Scalar>;

/// Matrix of equal entries, and identity matrix. If the number of columns is known at run time only, the matrix is
/// square. Eigen's Constant(), Zero() and Identity() are expressions, whose types cost compile time.
template <typename Whole>
[[nodiscard]] Whole filled(Eigen::Index rows, typename Whole::Scalar value = typename Whole::Scalar(0)) noexcept {
  Whole result;
  constexpr Eigen::Index kColumns = Whole::ColsAtCompileTime;
  result.resize(rows, kColumns == Eigen::Dynamic ? rows : kColumns);
  for (Eigen::Index i = 0; i < result.size(); ++i) result.coeffRef(i) = value;
  return result;
}
template <typename Square>
[[nodiscard]] Square identity(Eigen::Index rows = Square::RowsAtCompileTime) noexcept {
  auto result = filled<Square>(rows);
  for (Eigen::Index i = 0; i < result.rows(); ++i) result.coeffRef(i, i) = typename Square::Scalar(1);
  return result;
}

/// Joint state of an arm.
template <int N, typename Scalar = double>
struct State {
  Vector<N, Scalar> q;   ///< Joint positions [rad], or [m] for a prismatic joint.
  Vector<N, Scalar> qd;  ///< Joint velocities [rad/s], or [m/s].
};

}  // namespace fpbm
