#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>

#include "fpbm/bound/detail/distance.hpp"
#include "fpbm/model/chain.hpp"

namespace fpbm {

/// Shape of an obstacle.
template <typename Scalar = double>
using WorldShape = std::variant<Capsule<Scalar>, HalfSpace<Scalar>, Cuboid<Scalar>>;

/// Support of a capsule along n: the largest n·x of its points x.
template <typename Scalar>
[[nodiscard]] Scalar support(const Capsule<Scalar>& shape, const Vector<3, Scalar>& n) noexcept {
  return std::max(n.dot(shape.a), n.dot(shape.b)) + shape.radius;
}

/// A shape in the environment of the arm, in the base frame. Each capsule of the arm keeps the margin to the obstacle.
template <typename Scalar = double>
struct Obstacle {
  using Vector3 = Vector<3, Scalar>;

  std::string name;
  WorldShape<Scalar> shape;
  Vector3 velocity;       ///< Expected velocity of all points [m/s].
  std::size_t moves = 0;  ///< Number of calls of Shapes::move().

  Obstacle(std::string its_name, const WorldShape<Scalar>& its_shape, const Vector3& its_velocity = Vector3::Zero())
      : name(std::move(its_name)), shape(its_shape), velocity(its_velocity) {}

  /// Throws std::invalid_argument if a number is not finite or out of range, or a normal is not a unit vector.
  void require_sound(const validation::Argument& argument) const {
    const auto finite = [&](const char* part, const Vector3& x) { validation::require_finite(argument + part, x); };
    finite(".velocity", velocity);
    if (const auto* capsule = std::get_if<Capsule<Scalar>>(&shape)) {
      finite(".a", capsule->a);
      finite(".b", capsule->b);
      validation::require_non_negative(argument + ".radius", capsule->radius);
    } else if (const auto* cuboid = std::get_if<Cuboid<Scalar>>(&shape)) {
      chain_check::require_transform(argument + ".pose", cuboid->pose);
      finite(".half", cuboid->half);
      if (!(cuboid->half.minCoeff() >= Scalar(0))) {
        validation::fail(argument + ".half", cuboid->half.minCoeff(), "not negative");
      }
    } else {
      const auto* wall = std::get_if<HalfSpace<Scalar>>(&shape);
      const Scalar length = wall->normal.norm();
      constexpr Scalar kTolerance = Scalar(1e-4);  // Relative error of distances: 0.1 mm at 1 m.
      if (!(std::abs(length - Scalar(1)) < kTolerance)) {
        validation::fail(argument + ".normal's length", length, "1");
      }
      if (!std::isfinite(wall->offset)) {
        validation::fail(argument + ".offset", wall->offset, "finite");
      }
    }
  }

  [[nodiscard]] Nearest<Scalar> nearest_to(const Capsule<Scalar>& body) const noexcept {
    return std::visit([&body](const auto& each) { return nearest(body, each); }, shape);
  }

  /// Support along n. For a half-space: its offset, the support along its own normal.
  [[nodiscard]] Scalar support_along(const Vector3& n) const noexcept {
    if (const auto* capsule = std::get_if<Capsule<Scalar>>(&shape)) return support(*capsule, n);
    if (const auto* cuboid = std::get_if<Cuboid<Scalar>>(&shape)) {
      return n.dot(cuboid->pose.p) + cuboid->pose.R.transpose().lazyProduct(n).cwiseAbs().dot(cuboid->half);
    }
    return std::get_if<HalfSpace<Scalar>>(&shape)->offset;
  }

  /// Lower bound on the distance from the obstacle to a ball [m]. Cheaper than nearest_to().
  [[nodiscard]] Scalar at_least(const Vector3& centre, Scalar radius) const noexcept {
    if (const auto* capsule = std::get_if<Capsule<Scalar>>(&shape)) {
      return (centre - (capsule->a + capsule->b) / Scalar(2)).norm() - radius -
             (capsule->b - capsule->a).norm() / Scalar(2) - capsule->radius;
    }
    if (const auto* cuboid = std::get_if<Cuboid<Scalar>>(&shape)) {
      const Vector3 x = cuboid->pose.R.transpose().lazyProduct(centre - cuboid->pose.p);
      return (x.cwiseAbs() - cuboid->half).cwiseMax(Scalar(0)).norm() - radius;
    }
    const auto* wall = std::get_if<HalfSpace<Scalar>>(&shape);
    return wall->normal.dot(centre) - wall->offset - radius;
  }
};

}  // namespace fpbm
