#pragma once

#include <type_traits>

#include "fpbm/geometry/rotation.hpp"
#include "fpbm/geometry/space.hpp"

/// Rates of a point y ⊕ p(t) of a task space, from the rates of the displacement p, and reversed. The rates differ for
/// orientations only: with the rotation vector p, the angular velocity is w = J p', and its derivative is
/// J p'' + J' p', where J = I + a [p] + b [p]², a = (1 − cos θ)/θ², b = (θ − sin θ)/θ³, θ = |p| (Bullo and Murray
/// 1995).
namespace fpbm {

template <typename Scalar>
class RotationRates {
 public:
  using Three = Vector<3, Scalar>;

  /// p: rotation vector, |p| ≤ π [rad].
  explicit RotationRates(const Three& p) noexcept : p_(p) {
    // Power series in θ², which have no cancellation at small angles. 14 terms are exact to round-off at π.
    const Scalar z = p.squaredNorm();
    Scalar power(1);  // (−θ²)^k/(2k + 2)!, and so on.
    Scalar factorial = Scalar(0.5);
    for (int k = 0; k < 14; ++k) {
      const auto n = static_cast<Scalar>(2 * k + 2);
      const Scalar odd = factorial / (n + Scalar(1));
      a_ += power * factorial;
      b_ += power * odd;
      const Scalar next = factorial / ((n + Scalar(1)) * (n + Scalar(2)));
      const Scalar next_odd = odd / ((n + Scalar(2)) * (n + Scalar(3)));
      a_rate_ -= n * power * next;
      b_rate_ -= n * power * next_odd;
      excess_ -= Scalar(2) * power * next;
      power *= -z;
      factorial = next;
    }
  }

  /// w for the rate p'.
  [[nodiscard]] Three velocity(const Three& pd) const noexcept {
    const Three across = cross<Scalar>(p_, pd);
    return pd + a_ * across + b_ * cross<Scalar>(p_, across);
  }
  /// w' for the rates p' and p''.
  [[nodiscard]] Three acceleration(const Three& pd, const Three& pdd) const noexcept {
    return velocity(pdd) + curvature(pd);
  }
  /// p' for w.
  [[nodiscard]] Three rate(const Three& w) const noexcept {
    const Three across = cross<Scalar>(p_, w);
    return w - Scalar(0.5) * across + (excess_ + b_) / (Scalar(2) * a_) * cross<Scalar>(p_, across);
  }
  /// p'' for w' and p'.
  [[nodiscard]] Three second_rate(const Three& wd, const Three& pd) const noexcept { return rate(wd - curvature(pd)); }

 private:
  /// J' p'.
  [[nodiscard]] Three curvature(const Three& pd) const noexcept {
    const Scalar along = p_.dot(pd);
    const Three across = cross<Scalar>(p_, pd);
    return along * (a_rate_ * across + b_rate_ * cross<Scalar>(p_, across)) + b_ * cross<Scalar>(pd, across);
  }

  Three p_;
  Scalar a_{0};
  Scalar b_{0};
  Scalar a_rate_{0};  ///< (da/dθ)/θ
  Scalar b_rate_{0};  ///< (db/dθ)/θ
  Scalar excess_{0};  ///< (2a − 1)/θ²
};

/// Velocity and acceleration of a point, or the rates of its displacement.
template <typename Twist>
struct Rates {
  Twist xd;
  Twist xdd;
};

/// Velocity and acceleration of y ⊕ p.
template <typename Space, typename Scalar, typename Twist>
[[nodiscard]] Rates<Twist> rates_of_point(const Twist& p, Rates<Twist> of_p) noexcept {
  if constexpr (std::is_same_v<Space, Pose>) {
    const RotationRates<Scalar> rates(p.template tail<3>());
    const Vector<3, Scalar> pd = of_p.xd.template tail<3>();
    of_p.xdd.template tail<3>() = rates.acceleration(pd, of_p.xdd.template tail<3>());
    of_p.xd.template tail<3>() = rates.velocity(pd);
  }
  return of_p;
}

/// Rates of p for a velocity and an acceleration of y ⊕ p.
template <typename Space, typename Scalar, typename Twist>
[[nodiscard]] Rates<Twist> rates_of_displacement(const Twist& p, Rates<Twist> of_point) noexcept {
  if constexpr (std::is_same_v<Space, Pose>) {
    const RotationRates<Scalar> rates(p.template tail<3>());
    const Vector<3, Scalar> pd = rates.rate(of_point.xd.template tail<3>());
    of_point.xdd.template tail<3>() = rates.second_rate(of_point.xdd.template tail<3>(), pd);
    of_point.xd.template tail<3>() = pd;
  }
  return of_point;
}

}  // namespace fpbm
