#pragma once

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/detail/sincos.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/path/detail/curve.hpp"

namespace fpbm {

/// Circle of radius r [m], counterclockwise from its rightmost point: r (cos φ − 1, sin φ), φ = 2πs.
template <typename Scalar_ = double>
class Circle {
 public:
  using Scalar = Scalar_;
  using Space = Position<2>;

  explicit Circle(Scalar radius) : radius_(radius) { validation::require_positive("radius", radius); }

  [[nodiscard]] Curve<Space, Scalar> at(Scalar s) const noexcept {
    constexpr auto kRate = static_cast<Scalar>(kTwoPi);
    const SinCos<Scalar> phi = sincos(kRate * s);
    const Scalar x = radius_ * phi.cos;
    const Scalar y = radius_ * phi.sin;
    return {{x - radius_, y}, {-kRate * y, kRate * x}, {-kRate * kRate * x, -kRate * kRate * y}};
  }

 private:
  Scalar radius_;
};

/// Lissajous figure: (a_x (cos(f_x φ + δ) − cos δ), a_y (sin(f_y φ + δ) − sin δ)), φ = 2πs.
/// Amplitudes a [m], integer frequencies f (so that the figure closes), phase δ [rad].
template <typename Scalar_ = double>
class Lissajous {
 public:
  using Scalar = Scalar_;
  using Space = Position<2>;

  Lissajous(const Vector<2, Scalar>& amplitudes, const Vector<2, int>& frequencies, Scalar phase)
      : amplitudes_(amplitudes), rates_(static_cast<Scalar>(kTwoPi) * frequencies.cast<Scalar>()), phase_(phase) {
    const SinCos<Scalar> origin = sincos(phase);
    start_ = {amplitudes(0) * origin.cos, amplitudes(1) * origin.sin};
    validation::require_positive("amplitudes", amplitudes);
    validation::require_positive("frequencies", frequencies);
    validation::require_finite("phase", phase);
  }

  [[nodiscard]] Curve<Space, Scalar> at(Scalar s) const noexcept {
    const SinCos<Scalar> x = sincos(rates_(0) * s + phase_);
    const SinCos<Scalar> y = sincos(rates_(1) * s + phase_);
    const Vector<2, Scalar> p{amplitudes_(0) * x.cos, amplitudes_(1) * y.sin};
    const Vector<2, Scalar> p1{-amplitudes_(0) * x.sin, amplitudes_(1) * y.cos};
    return {p - start_, rates_.cwiseProduct(p1), -rates_.cwiseAbs2().cwiseProduct(p)};
  }

 private:
  Vector<2, Scalar> amplitudes_;
  Vector<2, Scalar> rates_;
  Scalar phase_;
  Vector<2, Scalar> start_;
};

/// Tricuspid (deltoid) of size a [m], from its rightmost cusp: a (2 cos φ + cos 2φ − 3, 2 sin φ − sin 2φ), φ = 2πs.
template <typename Scalar_ = double>
class Tricuspid {
 public:
  using Scalar = Scalar_;
  using Space = Position<2>;

  explicit Tricuspid(Scalar size) : size_(size) { validation::require_positive("size", size); }

  [[nodiscard]] Curve<Space, Scalar> at(Scalar s) const noexcept {
    constexpr auto kRate = static_cast<Scalar>(kTwoPi);
    const SinCos<Scalar> phi = sincos(kRate * s);
    const Scalar c1 = size_ * Scalar(2) * phi.cos;
    const Scalar s1 = size_ * Scalar(2) * phi.sin;
    const Scalar c2 = size_ * (phi.cos * phi.cos - phi.sin * phi.sin);
    const Scalar s2 = size_ * Scalar(2) * phi.sin * phi.cos;
    return {{c1 + c2 - Scalar(3) * size_, s1 - s2},
            {-kRate * (s1 + Scalar(2) * s2), kRate * (c1 - Scalar(2) * c2)},
            {-kRate * kRate * (c1 + Scalar(4) * c2), kRate * kRate * (Scalar(4) * s2 - s1)}};
  }

 private:
  Scalar size_;
};

/// Straight line along a displacement [m] of M coordinates.
template <int M, typename Scalar_ = double>
class Line {
 public:
  using Scalar = Scalar_;
  using Space = Position<M>;

  explicit Line(const Vector<M, Scalar>& displacement) : displacement_(displacement) {
    validation::require_finite("displacement", displacement);
  }

  [[nodiscard]] Curve<Space, Scalar> at(Scalar s) const noexcept {
    return {displacement_ * s, displacement_, filled<Vector<M, Scalar>>(M)};
  }

 private:
  Vector<M, Scalar> displacement_;
};

}  // namespace fpbm
