#pragma once

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/time_law.hpp"

namespace fpbm {

/// Path of positions at constant orientation of the tip, or with a rotation from rest to rest over the whole duration.
///
/// The rotation is a rotation vector r along the axes of the base frame [rad] (in the plane: an angle), relative to the
/// start orientation of the tip: R(t) = rotation(s r) R(0). The angular velocity is exactly ṡ r, and its derivative
/// s̈ r. To end in an orientation R, set r = rotation_vector(R R(0)ᵀ).
template <typename Path, typename TimeLaw = Quintic>
class WithRotation {
  using Positions = typename Path::Space;

 public:
  using Scalar = typename Path::Scalar;
  using Space = typename PoseOver<Positions>::type;
  using Rotation = Vector<Space::kRows - Positions::kRows, Scalar>;

  /// Constant orientation.
  explicit WithRotation(const Path& path) : WithRotation(path, filled<Rotation>(Rotation::RowsAtCompileTime)) {}

  /// Throws std::invalid_argument unless rotation is finite.
  WithRotation(const Path& path, const Rotation& rotation, const TimeLaw& time_law = {})
      : path_(path), rotation_(rotation), time_law_(time_law) {
    validation::require_finite("rotation", rotation);
  }

  [[nodiscard]] Scalar duration() const noexcept { return path_.duration(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    const Reference<Positions, Scalar> position = sample_within(path_, t, since);
    const Scalar T = path_.duration();
    Phase<Scalar> phase = time_law_.at(t < Scalar(0) ? Scalar(0) : t > T ? Scalar(1) : t / T);
    if (t < Scalar(0) || t > T) phase.sd = phase.sdd = Scalar(0);
    return {Space::displace(Space::template origin<Scalar>(), join(position.x, phase.s)),
            join(position.xd, phase.sd / T), join(position.xdd, phase.sdd / (T * T))};
  }

 private:
  /// Linear rows, and the rotation vector times `fraction`.
  [[nodiscard]] Vector<Space::kRows, Scalar> join(const Vector<Positions::kRows, Scalar>& linear,
                                                  Scalar fraction) const noexcept {
    constexpr int kLinear = Positions::kRows;
    Vector<Space::kRows, Scalar> result;
    for (int i = 0; i < kLinear; ++i) result.coeffRef(i) = linear.coeff(i);
    for (int i = kLinear; i < Space::kRows; ++i) result.coeffRef(i) = rotation_.coeff(i - kLinear) * fraction;
    return result;
  }

  Path path_;
  Rotation rotation_;
  TimeLaw time_law_;
};

}  // namespace fpbm
