#pragma once

#include <cmath>

#include "fpbm/clearance/clearance.hpp"

namespace fpbm {

/// A plane between the shapes of a pair, with normal n, fixed to the second one: both ends of the first one's axis stay
/// on its side for as long as their gaps n·x − radius − (support of the second along n) are not negative, and the
/// distance is never less than the smaller gap. Where the shapes are nearest to one another, it equals that.
template <int N, typename Scalar>
struct Separation {
  using ChainVector = typename Clearance<N, Scalar>::ChainVector;
  using Vector3 = Vector<3, Scalar>;

  Scalar distance;
  Scalar closing;  ///< Speed of the second shape toward the first [m/s].
  Scalar gap[2];
  ChainVector gradient[2];  ///< Of the gaps, by the chain's joints.
  Scalar at;                ///< Where the first one's axis is nearest: 0 at one end, 1 at the other.

  Separation(const Clearance<N, Scalar>& clearance, const ShapePair& pair) noexcept
      : Separation(clearance, pair, clearance.nearest_of(pair)) {}

  /// found: that of the pair.
  Separation(const Clearance<N, Scalar>& clearance, const ShapePair& pair, const Nearest<Scalar>& found) noexcept {
    const auto& body = clearance.bodies()[pair.first];
    const Vector3& n = found.normal;
    distance = found.distance;
    closing = Scalar(0);
    Scalar beyond;
    Eigen::Index from = 0;
    if (pair.world) {
      const auto& obstacle = clearance.obstacles()[pair.second];
      beyond = obstacle.support_along(n);
      closing = n.dot(obstacle.velocity);
    } else {
      const auto& other = clearance.bodies()[pair.second];
      beyond = support(other.now, n);
      from = other.link;
    }
    const Vector3 ends[2] = {body.now.a, body.now.b};
    const Vector3 axis = body.now.b - body.now.a;
    const Scalar squared = axis.squaredNorm();
    const Vector3 on_axis = found.on_first + body.now.radius * n - body.now.a;
    at = squared > Scalar(0) ? std::clamp(axis.dot(on_axis) / squared, Scalar(0), Scalar(1)) : Scalar(0);
    for (int e = 0; e < 2; ++e) {
      gap[e] = n.dot(ends[e]) - body.now.radius - beyond;
      gradient[e].setZero(clearance.links().count());
    }
    const Vector3 moments[2] = {cross(ends[0], n), cross(ends[1], n)};
    if (body.is_direction) {
      set_direction(clearance, body.link, moments[0]);
      return;
    }
    for (Eigen::Index k = from; k < body.link; ++k) {
      const Transform<Scalar>& frame = clearance.frames()[static_cast<std::size_t>(k + 1)];
      const Vector3 z = frame.R.col(2);
      const bool turns = clearance.links().turns(k);
      // n · (z × (x − p)) = z · ((x − p) × n)
      const Vector3 offset = cross(frame.p, n);
      for (int e = 0; e < 2; ++e) gradient[e](k) = turns ? z.dot(moments[e] - offset) : z.dot(n);
    }
  }

  /// Gradient of the distance, by the chain's joints.
  [[nodiscard]] ChainVector of_distance() const noexcept { return gradient[0] + at * (gradient[1] - gradient[0]); }

 private:
  /// Of a direction x, which only turning joints move: n · (z × x) = z · (x × n).
  void set_direction(const Clearance<N, Scalar>& clearance, Eigen::Index link, const Vector3& moment) noexcept {
    for (Eigen::Index k = 0; k < link; ++k) {
      if (clearance.links().turns(k)) {
        gradient[0](k) = gradient[1](k) = clearance.frames()[static_cast<std::size_t>(k + 1)].R.col(2).dot(moment);
      }
    }
  }
};

}  // namespace fpbm
