#include "bounds.hpp"

namespace fpbm::bindings {

AnyBounds::AnyBounds(const Clearance<kDynamic>& clearance, const TaskBounds<kDynamic>& walls,
                     const SpeedBounds<kDynamic>& speeds, const OptionalTorqueBounds& torques)
    : all_(clearance, walls, speeds, torques) {}

AnyBounds::AnyBounds(const AnyBounds& other) = default;
AnyBounds::AnyBounds(AnyBounds&& other) noexcept = default;
AnyBounds::~AnyBounds() = default;

void AnyBounds::gaps(const JointVector& q, double range,
                     const std::function<void(double, const JointVector&)>& f) noexcept {
  all_.gaps(q, range, f);
}

void AnyBounds::require(const JointVector& q) {
  all_.require(q);
}
double AnyBounds::closeness(const JointVector& q, double range) noexcept {
  return all_.closeness(q, range);
}
double AnyBounds::speed_ratio(const JointVector& q, const JointVector& qd) noexcept {
  return all_.speed_ratio(q, qd);
}
JointVector AnyBounds::away(const JointVector& q) noexcept {
  return all_.away(q);
}
void AnyBounds::torque_ratios(const JointVector& q, const JointVector& qd, const JointVector& qdd,
                              const std::function<void(double)>& f) const {
  all_.torque_ratios(q, qd, qdd, f);
}

template <Level kLevel>
void AnyBounds::require_limits(const Limits<kLevel, kDynamic>& limits) const {
  all_.require_limits(limits);
}
template <Level kLevel>
Rows<kDynamic, AnyBounds::kRows> AnyBounds::rows(const NextMotion<kLevel, kDynamic>& next) noexcept {
  return all_.rows(next);
}
template <Level kLevel>
bool AnyBounds::accepts(const Limits<kLevel, kDynamic>& limits, const State<kDynamic>& from,
                        const Stop<kLevel, kDynamic>& stop) noexcept {
  return all_.accepts(limits, from, stop);
}

template <Level kLevel>
using NextOf = NextMotion<kLevel, kDynamic>;
template <Level kLevel>
using LimitsOf = Limits<kLevel, kDynamic>;
template <Level kLevel>
using StopOf = Stop<kLevel, kDynamic>;
using AnyRows = Rows<kDynamic, AnyBounds::kRows>;
template void AnyBounds::require_limits(const LimitsOf<Level::kVelocity>&) const;
template void AnyBounds::require_limits(const LimitsOf<Level::kAcceleration>&) const;
template AnyRows AnyBounds::rows(const NextOf<Level::kVelocity>&) noexcept;
template AnyRows AnyBounds::rows(const NextOf<Level::kAcceleration>&) noexcept;
template bool AnyBounds::accepts(const LimitsOf<Level::kVelocity>&, const State<kDynamic>&,
                                 const StopOf<Level::kVelocity>&) noexcept;
template bool AnyBounds::accepts(const LimitsOf<Level::kAcceleration>&, const State<kDynamic>&,
                                 const StopOf<Level::kAcceleration>&) noexcept;

}  // namespace fpbm::bindings
