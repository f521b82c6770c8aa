#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/detail/sincos.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/path/shapes.hpp"

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

/// A path has a Scalar, a Space, a duration() [s], and a sample(t) for any t in any order. x of the sample is a
/// displacement from the start position of the tip; xd and xdd are velocity and acceleration. Before 0 and after
/// the duration, the sample is at rest at the ends of the path.
///
/// A path whose acceleration is discontinuous between its ends also has sample(t, since): the sample at t of the piece
/// that is active just after `since`. A step of an integrator then stays within one piece.
template <typename Path, typename = void>
inline constexpr bool kHasPieces = false;
template <typename Path>
inline constexpr bool kHasPieces<
    Path, std::void_t<decltype(std::declval<const Path&>().sample(typename Path::Scalar(), typename Path::Scalar()))>> =
    true;

/// Sample of any path at t, from the piece that is active just after `since`.
template <typename Path>
[[nodiscard]] Reference<typename Path::Space, typename Path::Scalar> sample_within(
    const Path& path, typename Path::Scalar t, [[maybe_unused]] typename Path::Scalar since) noexcept {
  if constexpr (kHasPieces<Path>) {
    return path.sample(t, since);
  } else {
    return path.sample(t);
  }
}

/// Path along a shape with a time law, of T seconds. After T, the path stays at the end of the shape.
///
/// With s(τ), τ = t/T, from the time law and d(s) from the shape:
///   x = d(s),  xd = d′ ṡ,  xdd = d″ ṡ² + d′ s̈,
/// where x is a displacement from the start position of the tip.
template <typename Shape, typename TimeLaw = SinSquared>
class Path {
 public:
  using Scalar = typename Shape::Scalar;
  using Space = typename Shape::Space;

  /// Throws std::invalid_argument unless duration [s] is positive and finite.
  Path(const Shape& shape, Scalar duration, const TimeLaw& time_law = {})
      : shape_(shape), duration_(duration), time_law_(time_law) {
    validation::require_positive("duration", duration);
  }

  [[nodiscard]] Scalar duration() const noexcept { return duration_; }

  /// Reference at t [s]: on the path for 0 ≤ t ≤ T, otherwise at rest at the nearest end.
  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept {
    if (t < Scalar(0)) return Reference<Space, Scalar>::hold(shape_.at(Scalar(0)).d);
    if (t > duration_) return Reference<Space, Scalar>::hold(shape_.at(Scalar(1)).d);
    const Phase<Scalar> phase = time_law_.at(t / duration_);
    const Scalar sd = phase.sd / duration_;
    const Scalar sdd = phase.sdd / (duration_ * duration_);
    const Curve<Space, Scalar> curve = shape_.at(phase.s);
    const auto& d1 = curve.d1;
    const auto& d2 = curve.d2;
    const Scalar square = sd * sd;
    return {curve.d, entrywise(d1, [&](Eigen::Index i) { return d1.coeff(i) * sd; }),
            entrywise(d2, [&](Eigen::Index i) { return d2.coeff(i) * square + d1.coeff(i) * sdd; })};
  }

 private:
  Shape shape_;
  Scalar duration_;
  TimeLaw time_law_;
};

}  // namespace fpbm
