#pragma once

#include "fpbm/geometry/detail/sincos.hpp"

namespace fpbm {

/// Fraction s of a path, and its first two derivatives with respect to τ.
template <typename Scalar>
struct Phase {
  Scalar s;
  Scalar sd;
  Scalar sdd;
};

/// Time law of the paper, s(τ) = sin²(πτ/2): at rest at both ends, where the acceleration is discontinuous.
struct SinSquared {
  template <typename Scalar>
  [[nodiscard]] static Phase<Scalar> at(Scalar tau) noexcept {
    constexpr auto kPi = static_cast<Scalar>(3.14159265358979323846);
    const SinCos<Scalar> angle = sincos(kPi * tau);
    return {(Scalar(1) - angle.cos) / Scalar(2), kPi / Scalar(2) * angle.sin, kPi * kPi / Scalar(2) * angle.cos};
  }
};

/// s(τ) = 10τ³ − 15τ⁴ + 6τ⁵: velocity and acceleration are zero at both ends.
struct Quintic {
  template <typename Scalar>
  [[nodiscard]] static Phase<Scalar> at(Scalar tau) noexcept {
    const Scalar rest = Scalar(1) - tau;
    return {tau * tau * tau * (Scalar(10) + tau * (Scalar(6) * tau - Scalar(15))), Scalar(30) * tau * tau * rest * rest,
            Scalar(60) * tau * rest * (rest - tau)};
  }
};

/// s(τ) = τ: constant speed of the parameter. The velocity is discontinuous at both ends.
struct ConstantSpeed {
  template <typename Scalar>
  [[nodiscard]] static Phase<Scalar> at(Scalar tau) noexcept {
    return {tau, Scalar(1), Scalar(0)};
  }
};

}  // namespace fpbm
