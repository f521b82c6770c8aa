#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "fpbm/path/detail/fastest_clock.hpp"
#include "fpbm/path/detail/kept_motion.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// The plan of a motion along a path.
struct PlannedMotion {
  FastestClock clock;
  std::vector<double> q;          ///< KeptMotion::q
  std::vector<double> closeness;  ///< KeptMotion::closeness
  KeptMotion motion;

  PlannedMotion(FastestClock its_clock, double ramp, double step, std::vector<double> postures,
                std::vector<double> its_closeness)
      : clock(std::move(its_clock)),
        q(std::move(postures)),
        closeness(std::move(its_closeness)),
        motion{ramp,
               step,
               static_cast<Eigen::Index>(q.size() / closeness.size()),
               static_cast<Eigen::Index>(closeness.size()),
               q.data(),
               closeness.data()} {}
  PlannedMotion(const PlannedMotion&) = delete;
  PlannedMotion& operator=(const PlannedMotion&) = delete;
  ~PlannedMotion() = default;
};

/// A path whose time law is replaced by the clock of a PlannedMotion. Copies share the plan. Without a plan, the path
/// itself.
template <typename Path>
class TimedPath {
 public:
  using Scalar = double;
  using Space = typename Path::Space;

  TimedPath(const Path& path, std::shared_ptr<const PlannedMotion> plan) : path_(path), plan_(std::move(plan)) {}

  [[nodiscard]] double duration() const noexcept { return plan_ ? plan_->clock.duration() : path_.duration(); }
  /// The motion along the path, which a PathFollower keeps.
  [[nodiscard]] const KeptMotion* motion() const noexcept { return plan_ ? &plan_->motion : nullptr; }

  /// x(p), x′ṗ, x″ṗ² + x′p̈; outside of the motion, at rest at the nearest end.
  [[nodiscard]] Reference<Space> sample(double t) const noexcept {
    if (!plan_) return path_.sample(t);
    const Phase<double> clock = plan_->clock.at(t);
    Reference<Space> reference = path_.sample(clock.s);
    reference.xdd = reference.xdd * (clock.sd * clock.sd) + reference.xd * clock.sdd;
    reference.xd *= clock.sd;
    return reference;
  }

 private:
  Path path_;
  std::shared_ptr<const PlannedMotion> plan_;
};

}  // namespace fpbm
