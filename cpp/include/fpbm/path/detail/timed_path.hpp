#pragma once

#include <memory>
#include <utility>

#include "fpbm/path/detail/kept_motion.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// A path whose time law is replaced by the clock of a KeptMotion. Copies share the motion.
template <typename Path>
class TimedPath {
 public:
  using Scalar = double;
  using Space = typename Path::Space;

  TimedPath(const Path& path, std::shared_ptr<const KeptMotion> motion) : path_(path), motion_(std::move(motion)) {}

  [[nodiscard]] double duration() const noexcept { return motion_->clock.duration(); }
  /// The motion along the path, for a PathFollower.
  [[nodiscard]] const std::shared_ptr<const KeptMotion>& motion() const noexcept { return motion_; }

  /// x(p), x′ṗ, x″ṗ² + x′p̈; outside of the motion, at rest at the nearest end.
  [[nodiscard]] Reference<Space> sample(double t) const noexcept {
    const Phase<double> clock = motion_->clock.at(t);
    Reference<Space> reference = path_.sample(clock.s);
    reference.xdd = reference.xdd * (clock.sd * clock.sd) + reference.xd * clock.sdd;
    reference.xd *= clock.sd;
    return reference;
  }

 private:
  Path path_;
  std::shared_ptr<const KeptMotion> motion_;
};

}  // namespace fpbm
