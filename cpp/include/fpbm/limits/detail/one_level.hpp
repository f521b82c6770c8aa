#pragma once

#include "fpbm/limits/detail/saturation.hpp"

/// Functions by which Limiter resolves one task level or TaskLevels. Here, the Jacobian of a task is the only level.
namespace fpbm {

template <int M, int N, typename Scalar>
[[nodiscard]] const Matrix<M, N, Scalar>& first_level(const Matrix<M, N, Scalar>& J) noexcept {
  return J;
}

/// Desired motion of the first level alone.
template <int M, int N, typename Scalar>
[[nodiscard]] const Vector<N, Scalar>& first_motion(const Matrix<M, N, Scalar>&,
                                                    const Vector<N, Scalar>& desired) noexcept {
  return desired;
}

/// Whether tasks have levels below the first level.
template <typename Tasks>
inline constexpr bool kHasLower = false;

/// Result with the motion u and the same scale for every level.
template <int M, int N, typename Scalar>
[[nodiscard]] SaturatedMotion<N, Scalar> with_scale(const Matrix<M, N, Scalar>&, const Vector<N, Scalar>& u,
                                                    Scalar scale) noexcept {
  return {u, scale, 0, 0};
}

/// Sets the scale of every level.
template <int N, typename Scalar>
void set_scale(SaturatedMotion<N, Scalar>& motion, Scalar scale) noexcept {
  motion.scale = scale;
}

/// Multiplies the scale of each level by the scale that another motion has for the level.
template <int N, typename Scalar>
void multiply_scales(SaturatedMotion<N, Scalar>& motion, const SaturatedMotion<N, Scalar>& other) noexcept {
  motion.scale *= other.scale;
}

/// Multiplies the scale of the first level by first(J), and the scale of each lower level by lower(J), where J is the
/// Jacobian of the level.
template <int M, int N, typename Scalar, typename First, typename Lower>
void multiply_scales(SaturatedMotion<N, Scalar>& motion, const Matrix<M, N, Scalar>& J, const First& first,
                     const Lower&) noexcept {
  motion.scale *= first(J);
}

template <int M, int N, typename Scalar, int P>
[[nodiscard]] NullSpaceSaturation<M, N, Scalar, P> saturation_of(const Matrix<M, N, Scalar>& J,
                                                                 const Vector<N, Scalar>& unit,
                                                                 const Rows<N, P, Scalar>& rows) noexcept {
  NullSpaceSaturation<M, N, Scalar, P> saturation(J, unit, rows);
  saturation.limit_compensation();
  return saturation;
}

/// Resolves the levels below the first level. A single task has no lower levels.
template <int M, int N, typename Scalar, int P>
void resolve_lower(const NullSpaceSaturation<M, N, Scalar, P>&, const Box<N, Scalar>&, const Vector<N, Scalar>&,
                   const SaturatedMotion<N, Scalar>&) noexcept {}

}  // namespace fpbm
