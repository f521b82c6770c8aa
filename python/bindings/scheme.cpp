#include "scheme.hpp"

#include "fpbm/any/any_weights.hpp"

namespace fpbm::bindings {

template <Level kLevel, typename Space>
AnyScheme<kLevel, Space> Scheme::plain(const JointLimits<kDynamic>& limits) const {
  const AnyWeights W = std::visit(
      [](const auto& given) {
        using Given = std::decay_t<decltype(given)>;
        if constexpr (std::is_same_v<Given, Diagonal>) return AnyWeights(DiagonalWeights<kDynamic>(given));
        if constexpr (std::is_same_v<Given, Dense>) return AnyWeights(DenseWeights<kDynamic>(given));
        if constexpr (std::is_same_v<Given, std::monostate>) return AnyWeights(UnitWeights{});
      },
      weights);
  W.require_dof(limits.lower.size());
  return AnyScheme<kLevel, Space>(law<kLevel>(W, limits));
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
