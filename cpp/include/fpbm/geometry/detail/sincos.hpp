#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fpbm/core/detail/float_model.hpp"
#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/detail/float_sincos.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"

namespace fpbm {

/// sin and cos of one angle |x| ≤ kReach [rad], with an error of up to 2e-16. Has no branches, so that a loop of calls
/// vectorises.
///
/// Cody-Waite reduction by multiples of π/2 in two parts, then minimax polynomials on |r| ≤ π/4 (Remez; relative error
/// below 2⁻⁵⁷): W. J. Cody, W. Waite, Software Manual for the Elementary Functions, 1980.
struct ReducedSinCos {
  /// For |x| ≤ kReach, the product of the quadrant k with the first part of π/2 is exact: k < 2¹⁹, and the part has 31
  /// bits.
  static constexpr double kReach = 5e5;

  static void evaluate(double x, double& sine, double& cosine) noexcept {
#if defined(__clang__) && __clang_major__ >= 12
#pragma clang fp reassociate(off)  // With -fassociative-math, for which clang has no macro, k would not be an integer.
#endif
    constexpr double kRound = 6755399441055744.0;  // 1.5 · 2⁵²: the low bits of the sum are the nearest integer.
    const double shifted = x * kPerQuadrant + kRound;
    const double k = kHasExcessDigits ? nearest_integer(x * kPerQuadrant) : shifted - kRound;
    const Reduced<double> reduced = reduce(x, k);
    const std::uint64_t sin_r = bits(reduced.sine);
    const std::uint64_t cos_r = bits(reduced.cosine);

    // Quadrant k mod 4: an odd quadrant swaps sine and cosine. Bit 1 of k is the sign of the sine, bit 1 of k + 1 the
    // sign of the cosine.
    const std::uint64_t quadrant = bits(kHasExcessDigits ? k + kRound : shifted);
    const std::uint64_t swap = std::uint64_t{0} - (quadrant & 1U);
    sine = real(((sin_r & ~swap) | (cos_r & swap)) ^ ((quadrant & 2U) << 62));
    cosine = real(((cos_r & ~swap) | (sin_r & swap)) ^ (((quadrant + 1U) & 2U) << 62));
  }

  /// evaluate() for lanes. A lane with |x| > kReach becomes NaN.
  template <typename Scalar>
  static void evaluate(const Scalar& x, Scalar& sine, Scalar& cosine) noexcept {
    const Scalar k = round(x * Scalar(kPerQuadrant));
    const Reduced<Scalar> reduced = reduce(x, k);
    const Scalar half = floor(k * Scalar(0.5));
    const auto odd = k - Scalar(2) * half > Scalar(0.5);
    const auto upper = half - Scalar(2) * floor(half * Scalar(0.5)) > Scalar(0.5);
    sine = reduced.sine;
    cosine = reduced.cosine;
    where(odd, sine) = reduced.cosine;
    where(odd, cosine) = reduced.sine;
    where(upper, sine) = -sine;
    where(upper != odd, cosine) = -cosine;
    set_nan_unless(abs(x) <= Scalar(kReach), sine);
    set_nan_unless(abs(x) <= Scalar(kReach), cosine);
  }

 private:
  static constexpr double kPerQuadrant = 6.36619772367581343e-01;

  /// Nearest integer of x with excess precision (kHasExcessDigits), where adding and subtracting kRound leaves a
  /// fraction.
  static double nearest_integer(double x) noexcept {
    return static_cast<double>(static_cast<std::int64_t>(x + (x < 0.0 ? -0.5 : 0.5)));
  }

  template <typename Scalar>
  struct Reduced {
    Scalar sine;
    Scalar cosine;
  };

  /// sin and cos of r = x − k π/2.
  template <typename Scalar>
  static Reduced<Scalar> reduce(const Scalar& x, const Scalar& k) noexcept {
#if defined(__clang__) && __clang_major__ >= 12
#pragma clang fp reassociate(off)  // Reassociation would combine both parts of π/2, with an error of 2e-11.
#endif
    Scalar r = x - k * Scalar(1.57079632673412561e+00);
    r -= k * Scalar(6.07710050650619225e-11);

    const Scalar z = r * r;
    const Scalar z2 = z * z;
    const Scalar sin_tail = polynomial(z, z2,
                                       {1.58962138989828173e-10, -2.50507474905790061e-08, 2.75573136197019395e-06,
                                        -1.98412698295848523e-04, 8.33333333332211303e-03, -1.66666666666666297e-01});
    const Scalar cos_tail = polynomial(z, z2,
                                       {-1.13585252205869601e-11, 2.08757006287165171e-09, -2.75573141777659980e-07,
                                        2.48015872888465437e-05, -1.38888888888730492e-03, 4.16666666666665950e-02});
    const Scalar head = Scalar(1) - Scalar(0.5) * z;
    return {r + r * z * sin_tail, head + (((Scalar(1) - head) - Scalar(0.5) * z) + z2 * cos_tail)};
  }

  /// Polynomial, with the coefficient of the highest power first. Horner's rule in z² on sums of two terms has half the
  /// dependency chain of Horner's rule in z.
  template <typename Scalar>
  static Scalar polynomial(const Scalar& z, const Scalar& z2, const double (&coefficients)[6]) noexcept {
    const auto two = [&](int i) { return Scalar(coefficients[i]) * z + Scalar(coefficients[i + 1]); };
    return (two(0) * z2 + two(2)) * z2 + two(4);
  }

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

/// sin and cos of one angle [rad]. If |angle| > kReach, double and float use std::sin and std::cos, and a lane becomes
/// NaN. Other Scalars use the sin and cos of their type.
template <typename Scalar>
[[nodiscard]] SinCos<Scalar> sincos(Scalar angle) noexcept {
  using std::cos;
  using std::sin;
  if constexpr (kInLanes<Scalar>) {
    SinCos<Scalar> result;
    ReducedSinCos::evaluate(angle, result.sin, result.cos);
    return result;
  } else if constexpr (std::is_same_v<Scalar, double>) {
    if (std::abs(angle) <= ReducedSinCos::kReach) {
      SinCos<double> result;
      ReducedSinCos::evaluate(angle, result.sin, result.cos);
      return result;
    }
  } else if constexpr (std::is_same_v<Scalar, float>) {
    if (std::abs(angle) <= FloatSinCos::kReach) {
      SinCos<float> result;
      FloatSinCos::evaluate(angle, result.sin, result.cos);
      return result;
    }
  }
  return {sin(angle), cos(angle)};
}

/// Vector of N angles. For doubles, an odd N is rounded up to an even number, because two sines are computed in
/// parallel.
template <int N, typename Scalar>
using Angles = Vector<(N != Eigen::Dynamic && std::is_same_v<Scalar, double>) ? N + N % 2 : N, Scalar>;

/// Vector for the angles of n joints. The entries are not set.
template <int N, typename Scalar>
[[nodiscard]] Angles<N, Scalar> angles_of(Eigen::Index n) noexcept {
  Angles<N, Scalar> angles;
  angles.resize(N == Eigen::Dynamic ? n : Eigen::Index(Angles<N, Scalar>::SizeAtCompileTime));
  return angles;
}

/// sin and cos of each angle [rad].
template <int N, typename Scalar>
void sincos(const Vector<N, Scalar>& angles, Vector<N, Scalar>& sines, Vector<N, Scalar>& cosines) noexcept {
  const Eigen::Index n = angles.size();
  sines.resize(n);
  cosines.resize(n);
  if constexpr (std::is_same_v<Scalar, double>) {
    // Larger angles are tested one by one. The result for |angle| ≤ kReach is the same.
    if (squared_length(angles.data(), n) <= ReducedSinCos::kReach * ReducedSinCos::kReach) {
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
