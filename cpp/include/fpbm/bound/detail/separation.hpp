#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/bound/detail/shapes.hpp"

namespace fpbm {

/// Planes that separate two shapes, all with the normal n (docs/clearance_proof.md, "Proof"). n is fixed to the last
/// common link of the chains to both shapes.
///
/// Let a be an end of the axis of the first capsule, and b an end of the axis of the second capsule. The gap of a and b
/// is (n·a − radius of the first) − (n·b + radius of the second). The smallest gap is a lower bound on the distance of
/// the shapes. In the posture in which n is the normal at the nearest points, the smallest gap equals the distance. If
/// no joint moves the second shape only, the support of the second shape along n replaces n·b + radius.
template <typename Shapes>
struct Separation {
  using Scalar = typename Shapes::Scalar;
  using AllJoints = typename Shapes::AllJoints;
  using Placement = typename Shapes::Placement;
  using Vector3 = Vector<3, Scalar>;

  Scalar distance;
  Scalar closing;          ///< Velocity n·v of the second shape toward the first, if it is a moving obstacle [m/s].
  Scalar along[2];         ///< n·a − radius of the first shape, for both ends [m].
  Scalar beyond[2];        ///< n·b + radius of the second shape for both ends, or its support [m].
  AllJoints gradient[2];   ///< Gradient of `along` with respect to the joints.
  AllJoints of_beyond[2];  ///< Gradient of `beyond`, if joints move the second shape only.
  int seconds = 1;         ///< Number of ends of the second shape that are used.

  /// placed: the bodies of the shapes. found: nearest points of the pair in this placement. `placed` and `found`
  /// must outlive the separation.
  Separation(const Shapes& shapes, const Placement& placed, const ShapePair& pair,
             const Nearest<Scalar>& found) noexcept
      : found_(found), first_(placed.bodies[pair.first]) {
    const auto& body = first_;
    const Vector3& n = found.normal;
    distance = found.distance;
    closing = Scalar(0);
    set_ends(placed, body, pair.by_first, n, -body.radius, along, gradient);
    if (pair.world) {
      const auto& obstacle = shapes.obstacles()[pair.second];
      beyond[0] = obstacle.support_along(n);
      closing = n.dot(obstacle.velocity);
      return;
    }
    const auto& other = placed.bodies[pair.second];
    if (pair.by_second == 0) {
      beyond[0] = support(other, n);
      return;
    }
    seconds = 2;
    second_ = &other;
    set_ends(placed, other, pair.by_second, n, other.radius, beyond, of_beyond);
  }

  Separation(const Shapes&, const Placement&, const ShapePair&, Nearest<Scalar>&&) = delete;

  /// Position of the nearest point on the axis of the first shape, from 0 at one end to 1 at the other.
  [[nodiscard]] Scalar at() const noexcept {
    return nearest_on(first_, found_.on_first + first_.radius * found_.normal);
  }

  /// Gap of end e of the first shape and end f of the second shape [m].
  [[nodiscard]] Scalar gap(int e, int f) const noexcept { return along[e] - beyond[f]; }
  [[nodiscard]] AllJoints gradient_of(int e, int f) const noexcept {
    return seconds == 1 ? gradient[e] : AllJoints(gradient[e] - of_beyond[f]);
  }
  /// Gap of end e of the first shape and the support of the second shape [m].
  [[nodiscard]] Scalar gap(int e) const noexcept {
    return along[e] - (seconds == 1 ? beyond[0] : std::max(beyond[0], beyond[1]));
  }
  [[nodiscard]] AllJoints gradient_of(int e) const noexcept {
    return seconds == 1 ? gradient[e] : AllJoints(gradient[e] - between(of_beyond, at_second()));
  }
  /// Gradient of the distance with respect to the joints.
  [[nodiscard]] AllJoints of_distance() const noexcept {
    const AllJoints first = between(gradient, at());
    return seconds == 1 ? first : AllJoints(first - between(of_beyond, at_second()));
  }

 private:
  /// Position of the nearest point on the axis of the second shape.
  [[nodiscard]] Scalar at_second() const noexcept {
    return nearest_on(*second_, found_.on_first - (found_.distance + second_->radius) * found_.normal);
  }

  [[nodiscard]] static AllJoints between(const AllJoints (&ends)[2], Scalar fraction) noexcept {
    return ends[0] + fraction * (ends[1] - ends[0]);
  }

  /// Position, from 0 to 1, of the point on the axis of a capsule that is nearest to a point.
  [[nodiscard]] static Scalar nearest_on(const Capsule<Scalar>& capsule, const Vector3& point) noexcept {
    const Vector3 axis = capsule.b - capsule.a;
    const Scalar squared = axis.squaredNorm();
    const Vector3 offset = point - capsule.a;
    return squared > Scalar(0) ? std::clamp(axis.dot(offset) / squared, Scalar(0), Scalar(1)) : Scalar(0);
  }

  /// Sets n·x + more for both ends x of the axis of a body, and the gradients with respect to the joints.
  static void set_ends(const Placement& placed, const Capsule<Scalar>& capsule, JointBits joints, const Vector3& n,
                       Scalar more, Scalar (&value)[2], AllJoints (&gradient)[2]) noexcept {
    value[0] = n.dot(capsule.a) + more;
    value[1] = n.dot(capsule.b) + more;
    gradient[0] = placed.axes.gradient(n, capsule.a, joints);
    gradient[1] = placed.axes.gradient(n, capsule.b, joints);
  }

  const Nearest<Scalar>& found_;
  const Capsule<Scalar>& first_;
  const Capsule<Scalar>* second_ = nullptr;  ///< Set if joints move the second shape only.
};

}  // namespace fpbm
