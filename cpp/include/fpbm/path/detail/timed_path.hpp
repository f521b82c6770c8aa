#pragma once

#include <memory>
#include <utility>

#include "fpbm/path/fastest_clock.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// A path whose time law is replaced by the clock of FastestClock. Copies share the clock.
template <typename Path>
class TimedPath {
 public:
  using Scalar = double;
  using Space = typename Path::Space;

  /// ramp: least ramp of a PathFollower [s].
  TimedPath(const Path& path, std::shared_ptr<const FastestClock> clock, double ramp)
      : path_(path), clock_(std::move(clock)), ramp_(ramp) {}

  [[nodiscard]] double duration() const noexcept { return clock_->duration(); }
  /// Least ramp of a PathFollower with which no change of its rate exceeds a bound of the joints [s].
  [[nodiscard]] double ramp() const noexcept { return ramp_; }

  /// x(p), x′ṗ, x″ṗ² + x′p̈; outside of the motion, at rest at the nearest end.
  [[nodiscard]] Reference<Space> sample(double t) const noexcept {
    const Phase<double> clock = clock_->at(t);
    Reference<Space> reference = path_.sample(clock.s);
    reference.xdd = reference.xdd * (clock.sd * clock.sd) + reference.xd * clock.sdd;
    reference.xd *= clock.sd;
    return reference;
  }

 private:
  Path path_;
  std::shared_ptr<const FastestClock> clock_;
  double ramp_;
};

}  // namespace fpbm
