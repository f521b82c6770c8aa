#pragma once

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/path/path.hpp"

namespace fpbm {

/// Planar path in a plane of space: (x, y) becomes x u + y v.
template <typename Path>
class InPlane {
 public:
  using Scalar = typename Path::Scalar;
  using Space = Position<3>;

  /// u, v: directions of the axes of the path in the base frame, of any length.
  /// Throws std::invalid_argument unless u and v are finite and perpendicular.
  InPlane(const Path& path, const Vector<3, Scalar>& u, const Vector<3, Scalar>& v) : path_(path) {
    validation::require_finite("u", u);
    validation::require_finite("v", v);
    if (!(squared_norm(u) > Scalar(0) && squared_norm(v) > Scalar(0))) {
      validation::reject("u and v", ": must both be nonzero");
    }
    u_ = normalized(u);
    v_ = normalized(v);
    const Scalar cosine = u_(0) * v_(0) + u_(1) * v_(1) + u_(2) * v_(2);
    // Perpendicular directions with 6 decimals are accepted. The path then deviates by up to 1e-6 of its size.
    if (!(cosine * cosine < Scalar(1e-12))) {
      validation::fail("u v / |u| |v|", cosine, "0: u and v must be perpendicular");
    }
  }

  [[nodiscard]] Scalar duration() const noexcept { return path_.duration(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    const Reference<Position<2>, Scalar> flat = sample_within(path_, t, since);
    return {placed(flat.x), placed(flat.xd), placed(flat.xdd)};
  }

 private:
  [[nodiscard]] Vector<3, Scalar> placed(const Vector<2, Scalar>& flat) const noexcept {
    return entrywise(u_, [&](Eigen::Index i) { return u_.coeff(i) * flat.coeff(0) + v_.coeff(i) * flat.coeff(1); });
  }

  Path path_;
  Vector<3, Scalar> u_;
  Vector<3, Scalar> v_;
};

}  // namespace fpbm
