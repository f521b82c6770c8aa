#include "scheme.hpp"

namespace fpbm::bindings {

template <Level kLevel, typename Space>
AnyScheme<kLevel, Space> Scheme::plain(const JointLimits<kDynamic>& limits) const {
  using Any = AnyScheme<kLevel, Space>;
  const Eigen::Index dof = limits.lower.size();
  if (const auto* W = std::get_if<Dense>(&weights)) {
    validation::require_size("weights", W->rows(), dof);
    return Any(law<kLevel>(DenseWeights<kDynamic>(*W), limits));
  }
  if constexpr (kLevel == Level::kAcceleration) {  // With W = I both parts of the law need one factorisation only.
    if (std::holds_alternative<std::monostate>(weights)) return Any(law<kLevel>(UnitWeights{}, limits));
  }
  return Any(law<kLevel>(diagonal_weights<kDynamic>(dof), limits));
}

template AnyScheme<Level::kVelocity, Position<2>> Scheme::plain(const JointLimits<kDynamic>&) const;
template AnyScheme<Level::kVelocity, PlanarPose> Scheme::plain(const JointLimits<kDynamic>&) const;
template AnyScheme<Level::kVelocity, Position<3>> Scheme::plain(const JointLimits<kDynamic>&) const;
template AnyScheme<Level::kVelocity, Pose> Scheme::plain(const JointLimits<kDynamic>&) const;
template AnyScheme<Level::kAcceleration, Position<2>> Scheme::plain(const JointLimits<kDynamic>&) const;
template AnyScheme<Level::kAcceleration, PlanarPose> Scheme::plain(const JointLimits<kDynamic>&) const;
template AnyScheme<Level::kAcceleration, Position<3>> Scheme::plain(const JointLimits<kDynamic>&) const;
template AnyScheme<Level::kAcceleration, Pose> Scheme::plain(const JointLimits<kDynamic>&) const;

}  // namespace fpbm::bindings
