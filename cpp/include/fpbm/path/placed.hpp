#pragma once

#include <limits>
#include <type_traits>

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

/// One path after another: the second path starts at the end of the first. For more than two paths, nest sequences.
template <typename First, typename Second>
class Sequence {
 public:
  using Scalar = typename First::Scalar;
  using Space = typename First::Space;
  static_assert(std::is_same_v<Space, typename Second::Space> && std::is_same_v<Scalar, typename Second::Scalar>,
                "both paths must have the same task space and the same Scalar");

  Sequence(const First& first, const Second& second)
      : first_(first), second_(second), end_of_first_(first.sample(first.duration()).x) {}

  [[nodiscard]] Scalar duration() const noexcept { return first_.duration() + second_.duration(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    const Scalar T = first_.duration();
    // A step of an integrator ends at a multiple of its length. Because of round-off, a step may end just before or
    // after T.
    if (since < T * (Scalar(1) - kRounding)) return sample_within(first_, t < T ? t : T, since);
    const Scalar begun = t > T ? t - T : Scalar(0);
    Reference<Space, Scalar> reference = sample_within(second_, begun, since > T ? since - T : Scalar(0));
    reference.x = Space::template compose<Scalar>(end_of_first_, reference.x);
    return reference;
  }

 private:
  /// Relative tolerance. A multiple k h of the step h = T/k has a round-off error of at most ε.
  static constexpr Scalar kRounding = 8 * std::numeric_limits<Scalar>::epsilon();

  First first_;
  Second second_;
  typename Space::template Point<Scalar> end_of_first_;
};

}  // namespace fpbm
