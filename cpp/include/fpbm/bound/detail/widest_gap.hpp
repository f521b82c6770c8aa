#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

namespace fpbm {

/// Unit vector perpendicular to a vector, which may be zero.
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> perpendicular(const Vector<3, Scalar>& vector) noexcept {
  using std::abs;
  using std::sqrt;
  Eigen::Index least = 0;
  const Scalar size = vector.cwiseAbs().maxCoeff();
  if (!(size > Scalar(0))) return Vector<3, Scalar>::UnitZ();
  vector.cwiseAbs().minCoeff(&least);
  const Vector<3, Scalar> result = cross<Scalar>(vector / size, Vector<3, Scalar>::Unit(least));
  return result / sqrt(result.squaredNorm());
}

/// Component of a vector perpendicular to the direction `direction`. Returns the vector if `direction` is zero.
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> across(const Vector<3, Scalar>& vector, const Vector<3, Scalar>& direction) noexcept {
  const Scalar squared = direction.squaredNorm();
  if (!(squared > Scalar(0))) return vector;
  return vector - vector.dot(direction) / squared * direction;
}

/// Whether the difference of two nearest points is long enough to define a direction with three quarters of the digits
/// of Scalar. gap_squared: squared length of the difference. size_squared: squared size of the shapes.
template <typename Scalar>
[[nodiscard]] bool tells_direction(Scalar gap_squared, Scalar size_squared) noexcept {
  using Limits = std::numeric_limits<Scalar>;
  constexpr Scalar kRootOfEpsilon = sizeof(Scalar) == sizeof(float) ? Scalar(3.5e-4) : Scalar(1.5e-8);
  constexpr Scalar kNoRoundOff = Limits::min() / Limits::epsilon();
  return gap_squared > kRootOfEpsilon * size_squared + kNoRoundOff;
}

/// Finds the normal at the nearest points of two shapes that touch or overlap. The normal is the unit vector n, among
/// the offered directions, with the largest
///
///   gap(n) = |n·offset| − reach(n),
///
/// where offset is the vector from the centre of the second shape to the centre of the first, and reach(n) is the sum
/// of the half extents of both shapes along n. Both shapes must be convex and point-symmetric about their centres. The
/// signed distance of the shapes is the maximum of gap(n) over all unit vectors n. A wrong candidate is therefore
/// harmless: its gap is not larger than the maximum. If gaps are equal up to round-off, the first direction is kept.
template <typename Scalar, typename Reach>
class WidestGap {
 public:
  /// size: size of both shapes, for the round-off error of gaps. A gap is the difference of two sums of three products,
  /// with an error of at most 4 ε (size + Σ|offset_i|), and 8 ε for the difference of two gaps.
  WidestGap(const Vector<3, Scalar>& offset, const Reach& reach, Scalar size) noexcept
      : offset_(offset),
        reach_(reach),
        round_off_(Scalar(8) * std::numeric_limits<Scalar>::epsilon() * (size + offset.cwiseAbs().sum())) {}

  /// Offers a direction of any length and either sign. Zero is ignored.
  void offer(const Vector<3, Scalar>& direction) noexcept {
    using std::abs;
    using std::sqrt;
    const Scalar size = direction.cwiseAbs().maxCoeff();
    if (!(size > Scalar(0))) return;
    const Vector<3, Scalar> scaled = direction / size;  // The square does not underflow.
    const Vector<3, Scalar> normal = scaled / sqrt(scaled.squaredNorm());
    const Scalar along = normal.dot(offset_);
    const Scalar gap = abs(along) - reach_(normal);
    if (!(gap > gap_ + round_off_)) return;
    gap_ = gap;
    normal_ = along < Scalar(0) ? Vector<3, Scalar>(-normal) : normal;
  }

  [[nodiscard]] const Vector<3, Scalar>& normal() const noexcept { return normal_; }
  [[nodiscard]] Scalar gap() const noexcept { return gap_; }
  /// Round-off error of a gap.
  [[nodiscard]] Scalar round_off() const noexcept { return round_off_; }

 private:
  Vector<3, Scalar> offset_;
  Reach reach_;
  Scalar round_off_;
  Vector<3, Scalar> normal_ = Vector<3, Scalar>::UnitZ();
  Scalar gap_ = std::numeric_limits<Scalar>::lowest();
};

}  // namespace fpbm
