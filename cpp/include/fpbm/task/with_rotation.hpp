#pragma once

#include "fpbm/core/space.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/task/path.hpp"
#include "fpbm/task/time_law.hpp"

namespace fpbm {

/// A path of positions with the tip's orientation held, or turned from rest to rest over the path's whole duration.
///
/// The turn is a rotation vector r along the base frame's axes [rad] (in the plane: an angle), taken from where the tip
/// starts: R(t) = rotation(s r) R(0), so that the angular velocity is ṡ r and its derivative s̈ r, exactly. To turn to
/// an orientation R, r = rotation_vector(R R(0)ᵀ).
template <typename Path, typename TimeLaw = Quintic>
class WithRotation {
  using Positions = typename Path::Space;

 public:
  using Scalar = typename Path::Scalar;
  using Space = typename PoseOver<Positions>::type;
  using Turn = Vector<Space::kRows - Positions::kRows, Scalar>;

  /// Orientation held.
  explicit WithRotation(const Path& path) : WithRotation(path, Turn::Zero()) {}

  /// Throws std::invalid_argument unless turn is finite.
  WithRotation(const Path& path, const Turn& turn, const TimeLaw& time_law = {})
      : path_(path), turn_(turn), time_law_(time_law) {
    validation::require_finite("turn", turn);
  }

  [[nodiscard]] Scalar duration() const noexcept { return path_.duration(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    const Reference<Positions, Scalar> position = sample_within(path_, t, since);
    const Scalar T = path_.duration();
    Phase<Scalar> phase = time_law_.at(t < Scalar(0) ? Scalar(0) : t > T ? Scalar(1) : t / T);
    if (t < Scalar(0) || t > T) phase.sd = phase.sdd = Scalar(0);
    return {Space::displace(Space::template origin<Scalar>(), join(position.x, turn_ * phase.s)),
            join(position.xd, turn_ * (phase.sd / T)), join(position.xdd, turn_ * (phase.sdd / (T * T)))};
  }

 private:
  [[nodiscard]] static Vector<Space::kRows, Scalar> join(const Vector<Positions::kRows, Scalar>& linear,
                                                         const Turn& angular) noexcept {
    Vector<Space::kRows, Scalar> result;
    result.template head<Positions::kRows>() = linear;
    result.template tail<Turn::RowsAtCompileTime>() = angular;
    return result;
  }

  Path path_;
  Turn turn_;
  TimeLaw time_law_;
};

}  // namespace fpbm
