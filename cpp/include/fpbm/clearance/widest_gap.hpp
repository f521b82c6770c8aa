#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// A unit vector at right angles to a vector, which may be zero.
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

/// What is left of a vector without its part along a way, which may be zero.
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> across(const Vector<3, Scalar>& vector, const Vector<3, Scalar>& way) noexcept {
  const Scalar squared = way.squaredNorm();
  if (!(squared > Scalar(0))) return vector;
  return vector - vector.dot(way) / squared * way;
}

/// Are points whose gap squared this is far enough apart, for shapes so large (a length squared), that their difference
/// tells its direction? To all but a quarter of a Scalar's digits.
template <typename Scalar>
[[nodiscard]] bool tells_direction(Scalar gap_squared, Scalar size_squared) noexcept {
  using Limits = std::numeric_limits<Scalar>;
  constexpr Scalar kRootOfEpsilon = sizeof(Scalar) == sizeof(float) ? Scalar(3.5e-4) : Scalar(1.5e-8);
  constexpr Scalar kNoRoundOff = Limits::min() / Limits::epsilon();
  return gap_squared > kRootOfEpsilon * size_squared + kNoRoundOff;
}

/// Of the directions offered, that along which two shapes are farthest apart or, where they are not, least deep in one
/// another; of those as good, the first. The signed distance of convex shapes is the largest gap along any unit vector
/// n,
///
///   gap(n) = |n·offset| − reach(n),
///
/// for shapes that are their own mirror image at their centres: offset is from the second centre to the first, and
/// reach(n) is how far both reach along n, summed. So a direction offered that is wrong does no harm.
template <typename Scalar, typename Reach>
class WidestGap {
 public:
  /// size: that of both shapes, for round-off.
  WidestGap(const Vector<3, Scalar>& offset, const Reach& reach, Scalar size) noexcept
      : offset_(offset),
        reach_(reach),
        round_off_(Scalar(8) * std::numeric_limits<Scalar>::epsilon() * (size + offset.cwiseAbs().sum())) {}

  /// A direction of any length and either sign; zero is passed over.
  void offer(const Vector<3, Scalar>& direction) noexcept {
    using std::abs;
    using std::sqrt;
    const Scalar size = direction.cwiseAbs().maxCoeff();
    if (!(size > Scalar(0))) return;
    const Vector<3, Scalar> scaled = direction / size;  // Whose square cannot vanish.
    const Vector<3, Scalar> normal = scaled / sqrt(scaled.squaredNorm());
    const Scalar along = normal.dot(offset_);
    const Scalar gap = abs(along) - reach_(normal);
    if (!(gap > gap_ + round_off_)) return;
    gap_ = gap;
    normal_ = along < Scalar(0) ? Vector<3, Scalar>(-normal) : normal;
  }

  [[nodiscard]] const Vector<3, Scalar>& normal() const noexcept { return normal_; }
  [[nodiscard]] Scalar gap() const noexcept { return gap_; }
  /// What a gap is uncertain by.
  [[nodiscard]] Scalar round_off() const noexcept { return round_off_; }

 private:
  Vector<3, Scalar> offset_;
  Reach reach_;
  Scalar round_off_;
  Vector<3, Scalar> normal_ = Vector<3, Scalar>::UnitZ();
  Scalar gap_ = std::numeric_limits<Scalar>::lowest();
};

}  // namespace fpbm
