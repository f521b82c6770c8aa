#pragma once

#include "fpbm/core/space.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/task/path.hpp"

namespace fpbm {

/// A planar path in a plane of space: (x, y) becomes x u + y v.
template <typename Path>
class InPlane {
 public:
  using Scalar = typename Path::Scalar;
  using Space = Position<3>;

  /// u, v: directions of the path's axes in the base frame; their lengths do not matter.
  /// Throws std::invalid_argument unless they are finite and at right angles.
  InPlane(const Path& path, const Vector<3, Scalar>& u, const Vector<3, Scalar>& v) : path_(path) {
    validation::require_finite("u", u);
    validation::require_finite("v", v);
    if (!(u.norm() > Scalar(0) && v.norm() > Scalar(0))) validation::reject("u and v", ": must both be nonzero");
    axes_.col(0) = u.normalized();
    axes_.col(1) = v.normalized();
    const Scalar cosine = axes_.col(0).dot(axes_.col(1));
    if (!(cosine * cosine < Scalar(1e-12))) {
      validation::fail("u v / |u| |v|", cosine, "0: u and v are at right angles");
    }
  }

  [[nodiscard]] Scalar duration() const noexcept { return path_.duration(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    const Reference<Position<2>, Scalar> flat = sample_within(path_, t, since);
    return {axes_.lazyProduct(flat.x), axes_.lazyProduct(flat.xd), axes_.lazyProduct(flat.xdd)};
  }

 private:
  Path path_;
  Matrix<3, 2, Scalar> axes_;
};

}  // namespace fpbm
