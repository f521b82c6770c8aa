#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/linalg/detail/eigenpairs_below.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Principal moments of a rotational inertia, in ascending order [kg m²], and the principal axes as columns.
template <typename Scalar>
struct PrincipalAxes {
  Vector<3, Scalar> moments;
  Matrix<3, 3, Scalar> axes;

  explicit PrincipalAxes(const Matrix<3, 3, Scalar>& inertia) noexcept {
    const EigenpairsBelow<3, Scalar> pairs(inertia, std::numeric_limits<Scalar>::infinity());
    for (Eigen::Index k = 0; k < 3; ++k) {
      Eigen::Index rank = 0;
      for (Eigen::Index other = 0; other < 3; ++other) {
        if (pairs.value(other) < pairs.value(k) || (pairs.value(other) == pairs.value(k) && other < k)) ++rank;
      }
      moments(rank) = pairs.value(k);
      set_column(axes, rank, pairs.vector(k));
    }
  }
};

/// Conditions for the inertia of a link, in the order of the tests.
enum class InertiaFault : unsigned char { kNone, kNotFinite, kNegativeMass, kNotSymmetric, kNegativeMoment, kTriangle };

/// The first condition that the inertia of a link violates by more than round-off: published inertias have as few as 4
/// digits, and a radius of gyration below 1 µm is round-off.
template <typename Scalar>
[[nodiscard]] InertiaFault fault_of(const LinkInertia<Scalar>& link) noexcept {
  const auto& [mass, centre, inertia] = link;
  if (!std::isfinite(mass) || !is_finite(centre) || !is_finite(inertia)) return InertiaFault::kNotFinite;
  if (mass < Scalar(0)) return InertiaFault::kNegativeMass;
  const Scalar tolerance = Scalar(1e-4) * largest_magnitude(inertia) + Scalar(1e-12) * mass;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (std::abs(inertia.coeff(i, j) - inertia.coeff(j, i)) > tolerance) return InertiaFault::kNotSymmetric;
    }
  }
  const Vector<3, Scalar> moments = PrincipalAxes<Scalar>(inertia).moments;
  if (moments(0) < -tolerance) return InertiaFault::kNegativeMoment;
  if (moments(2) > moments(0) + moments(1) + tolerance) return InertiaFault::kTriangle;
  return InertiaFault::kNone;
}

/// Throws std::invalid_argument if the inertia of a link is not physical: the message names the violated condition.
template <typename Scalar>
void require_physical(const validation::Argument& name, const LinkInertia<Scalar>& link) {
  const InertiaFault fault = fault_of(link);
  if (fault == InertiaFault::kNone) return;
  if (fault == InertiaFault::kNotFinite) validation::reject(name, " has a number that is not finite");
  if (fault == InertiaFault::kNegativeMass) validation::fail(name + ".mass", link.mass, "finite and not negative");
  const validation::Argument inertia = name + ".inertia";
  if (fault == InertiaFault::kNotSymmetric) validation::reject(inertia, " is not symmetric: must be symmetric");
  const Vector<3, Scalar> moments = PrincipalAxes<Scalar>(link.inertia).moments;
  if (fault == InertiaFault::kNegativeMoment) {
    validation::reject_value(inertia, moments(0), " has the principal moment ", moments(0),
                             ": must have no negative principal moment, about the centre of mass");
  }
  validation::reject_value(inertia, moments(2), " has the principal moments ", moments(0), ", ", moments(1), " and ",
                           moments(2), ": the largest must be at most the sum of the others (triangle inequality)");
}

/// Inertia of a link that is given in a frame b, in a frame a. placement: the pose of b in a.
template <typename Scalar>
[[nodiscard]] LinkInertia<Scalar> placed(const Transform<Scalar>& placement, const LinkInertia<Scalar>& link) noexcept {
  const Vector<3, Scalar> turned = times(placement.R, link.centre);
  return {link.mass, entrywise(turned, [&](Eigen::Index i) { return placement.p.coeff(i) + turned.coeff(i); }),
          times(times(placement.R, link.inertia), transposed(placement.R))};
}

/// Inertia of two bodies that are fixed to each other, in the same frame.
template <typename Scalar>
[[nodiscard]] LinkInertia<Scalar> joined(const LinkInertia<Scalar>& a, const LinkInertia<Scalar>& b) noexcept {
  LinkInertia<Scalar> both;
  both.mass = a.mass + b.mass;
  const Scalar share = both.mass > Scalar(0) ? b.mass / both.mass : Scalar(0);
  const Vector<3, Scalar> d =
      entrywise(a.centre, [&](Eigen::Index i) { return b.centre.coeff(i) - a.centre.coeff(i); });
  both.centre = entrywise(d, [&](Eigen::Index i) { return a.centre.coeff(i) + share * d.coeff(i); });
  const Scalar reduced = a.mass * share;  // Parallel axes: both bodies about the common centre of mass.
  const Scalar square = squared_norm(d);
  both.inertia = entrywise(a.inertia, [&](Eigen::Index i) {
    const Eigen::Index row = i % 3;
    const Eigen::Index col = i / 3;
    return a.inertia.coeff(i) + b.inertia.coeff(i) +
           reduced * ((row == col ? square : Scalar(0)) - d.coeff(row) * d.coeff(col));
  });
  return both;
}

}  // namespace fpbm
