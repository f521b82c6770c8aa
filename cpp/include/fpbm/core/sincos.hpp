#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// sin and cos of one angle |x| ≤ kReach [rad], to 2e-16, with no branch, so that a loop over it
/// becomes vector code.
///
/// Cody-Waite reduction by multiples of π/2 in three parts, then minimax polynomials on |r| ≤ π/4 (Remez; relative
/// error below 2⁻⁵⁷): W. J. Cody, W. Waite, Software Manual for the Elementary Functions, 1980.
struct ReducedSinCos {
  static constexpr double kReach = 5e5;  ///< k · π/2 stays exact in its first part up to here.

  static void evaluate(double x, double& sine, double& cosine) noexcept {
    constexpr double kRound = 6755399441055744.0;  // 1.5 · 2⁵²: adding it leaves the nearest integer in the low bits.
    const double shifted = x * 6.36619772367581343e-01 + kRound;
    const double k = shifted - kRound;
    double r = x - k * 1.57079632673412561e+00;
    r -= k * 6.07710050630396598e-11;
    r -= k * 2.02226624879595063e-21;

    const double z = r * r;
    const double sin_tail =
        -1.66666666666666297e-01 +
        z * (8.33333333332211303e-03 +
             z * (-1.98412698295848523e-04 +
                  z * (2.75573136197019395e-06 + z * (-2.50507474905790061e-08 + z * 1.58962138989828173e-10))));
    const double cos_tail =
        4.16666666666665950e-02 +
        z * (-1.38888888888730492e-03 +
             z * (2.48015872888465437e-05 +
                  z * (-2.75573141777659980e-07 + z * (2.08757006287165171e-09 - z * 1.13585252205869601e-11))));
    const std::uint64_t sin_r = bits(r + r * z * sin_tail);
    const double head = 1.0 - 0.5 * z;
    const std::uint64_t cos_r = bits(head + (((1.0 - head) - 0.5 * z) + z * z * cos_tail));

    // Quadrant k mod 4: an odd one swaps sine and cosine, the upper bit of k and of k + 1 sets their signs.
    const std::uint64_t quadrant = bits(shifted);
    const std::uint64_t swap = std::uint64_t{0} - (quadrant & 1U);
    sine = real(((sin_r & ~swap) | (cos_r & swap)) ^ ((quadrant & 2U) << 62));
    cosine = real(((cos_r & ~swap) | (sin_r & swap)) ^ (((quadrant + 1U) & 2U) << 62));
  }

 private:
  static std::uint64_t bits(double value) noexcept {
    std::uint64_t result;
    std::memcpy(&result, &value, sizeof result);
    return result;
  }
  static double real(std::uint64_t value) noexcept {
    double result;
    std::memcpy(&result, &value, sizeof result);
    return result;
  }
};

/// Sine and cosine of one angle.
template <typename Scalar>
struct SinCos {
  Scalar sin;
  Scalar cos;
};

/// sin and cos of one angle [rad]. Scalars other than double use their own sin and cos.
template <typename Scalar>
[[nodiscard]] SinCos<Scalar> sincos(Scalar angle) noexcept {
  using std::cos;
  using std::sin;
  if constexpr (std::is_same_v<Scalar, double>) {
    if (std::abs(angle) <= ReducedSinCos::kReach) {
      SinCos<double> result;
      ReducedSinCos::evaluate(angle, result.sin, result.cos);
      return result;
    }
  }
  return {sin(angle), cos(angle)};
}

/// sin and cos of every angle [rad] at once.
template <int N, typename Scalar>
void sincos(const Vector<N, Scalar>& angles, Vector<N, Scalar>& sines, Vector<N, Scalar>& cosines) noexcept {
  const Eigen::Index n = angles.size();
  sines.resize(n);
  cosines.resize(n);
  if constexpr (std::is_same_v<Scalar, double>) {
    if (angles.cwiseAbs().maxCoeff() <= ReducedSinCos::kReach) {
      for (Eigen::Index i = 0; i < n; ++i) ReducedSinCos::evaluate(angles(i), sines(i), cosines(i));
      return;
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const SinCos<Scalar> pair = sincos(angles(i));
    sines(i) = pair.sin;
    cosines(i) = pair.cos;
  }
}

}  // namespace fpbm
