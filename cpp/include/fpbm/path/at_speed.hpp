#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/arc_length.hpp"
#include "fpbm/path/detail/curve.hpp"
#include "fpbm/path/detail/speed_profile.hpp"
#include "fpbm/path/path.hpp"

namespace fpbm {

/// Path at a constant tool speed, from rest to rest, with a ramp at both ends. Only the geometry of the given path
/// counts, not its time law. With the distance s(t) along the path [m], and derivatives ′ with respect to s:
///   x = x(s),  xd = x′ ṡ,  xdd = x″ ṡ² + x′ s̈.
/// Orientations follow the positions. Where the given path stops or changes its direction abruptly, as between the
/// parts of a Sequence, the tip stops.
///
/// The duration of each part between stops is rounded up to a multiple of 0.01 s by longer ramps, so that usual steps
/// divide the duration. Allocates at construction and when copied, never in sample().
template <typename Path>
class AtSpeed {
 public:
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;

  /// Speed [m/s], acceleration [m/s²] and jerk [m/s³] along the path. Without a bound on jerk, the acceleration is
  /// discontinuous at the ends of the ramps. Throws std::invalid_argument unless these numbers are positive, and finite
  /// (except jerk), and the path moves the tip in position.
  AtSpeed(const Path& path, Scalar speed, Scalar acceleration, Scalar jerk = std::numeric_limits<Scalar>::infinity())
      : distances_(path) {
    validation::require_positive("speed", speed);
    validation::require_positive("acceleration", acceleration);
    if (!(jerk > Scalar(0))) validation::fail("jerk", jerk, "positive");
    for (const auto& part : distances_.parts()) {
      profiles_.emplace_back(part.length(), speed, acceleration, jerk);
      ends_.push_back(duration() + profiles_.back().duration());
    }
  }

  [[nodiscard]] Scalar duration() const noexcept { return ends_.empty() ? Scalar(0) : ends_.back(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }

  /// Sample from the part between stops that is active just after `since`.
  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    if (t < Scalar(0)) return Reference<Space, Scalar>::hold(distances_.path().sample(Scalar(0)).x);
    if (t > duration()) return Reference<Space, Scalar>::hold(distances_.path().sample(distances_.path().duration()).x);
    // Because of round-off, a step may begin just before a stop.
    constexpr Scalar kRounding = Scalar(1) + 8 * std::numeric_limits<Scalar>::epsilon();
    const auto end = std::upper_bound(ends_.begin(), ends_.end() - 1, since * kRounding);
    const auto i = static_cast<std::size_t>(end - ends_.begin());
    const SpeedProfile<Scalar>& profile = profiles_[i];
    const Scalar begun = std::max(t - (i == 0 ? Scalar(0) : ends_[i - 1]), Scalar(0));
    const Phase<Scalar> phase = profile.at(std::min(begun, profile.duration()));
    const Curve<Space, Scalar> curve = distances_.at(distances_.parts()[i], phase.s);
    return {curve.d, curve.d1 * phase.sd, curve.d2 * (phase.sd * phase.sd) + curve.d1 * phase.sdd};
  }

 private:
  ArcLength<Path> distances_;
  std::vector<SpeedProfile<Scalar>> profiles_;  ///< One for each part.
  std::vector<Scalar> ends_;                    ///< End of each part [s].
};

}  // namespace fpbm
