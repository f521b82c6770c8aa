#include "scheme.hpp"

#include "fpbm/objective/manipulability_ascent.hpp"

namespace fpbm::bindings {
namespace {

/// Number of joints for which schemes have a fixed size; 0 for none. A fixed size makes the paper's arm a quarter
/// faster, and arms with a pose and one redundant joint faster by half.
template <typename Space>
constexpr int kOwnSize = std::is_same_v<Space, Position<2>> ? 4
                         : std::is_same_v<Space, Pose>      ? 7
                                                            : 0;

}  // namespace

AnyWeights any_weights(const Scheme& scheme, Eigen::Index dof) {
  const auto checked = [dof](const auto& weights) {
    weights.require_dof(dof);
    return AnyWeights(weights);
  };
  if (const auto* w = std::get_if<Scheme::Diagonal>(&scheme.weights)) return checked(DiagonalWeights<kDynamic>(*w));
  if (const auto* W = std::get_if<Scheme::Dense>(&scheme.weights)) return checked(DenseWeights<kDynamic>(*W));
  return checked(UnitWeights{});
}

Status resolve_rows(const LeastTorque& law, const TaskEquation<kDynamic, kDynamic>& task, const State<kDynamic>& state,
                    JointVector& u) noexcept {
  return law.resolve_rows(task, state, u);
}
Status resolve_rows(const LeastEnergy& law, const TaskEquation<kDynamic, kDynamic>& task, const State<kDynamic>& state,
                    JointVector& u) noexcept {
  return law.resolve_rows(task, state, u);
}

Scheme Scheme::on(const Model& model) const {
  Scheme scheme = *this;
  if (!uses_dynamics) return scheme;
  scheme.dynamics = std::make_shared<const AnyDynamics>(model.dynamics());
  return scheme;
}

template <typename Space>
EitherScheme<Space> Scheme::plain(const JointLimits<kDynamic>& limits) const {
  if (uses_dynamics) {
    if (level == Level::kVelocity) {
      return AnyScheme<Level::kVelocity, Space>(law_with_dynamics<Level::kVelocity>(limits));
    }
    return AnyScheme<Level::kAcceleration, Space>(law_with_dynamics<Level::kAcceleration>(limits));
  }
  const auto with = [&](const auto& W, const auto& bounds) -> EitherScheme<Space> {
    if (level == Level::kVelocity) return AnyScheme<Level::kVelocity, Space>(law<Level::kVelocity>(W, bounds));
    return AnyScheme<Level::kAcceleration, Space>(law<Level::kAcceleration>(W, bounds));
  };
  const Eigen::Index dof = limits.lower.size();
  if constexpr (constexpr int N = kOwnSize<Space>; N > 0) {
    if (dof == N && !std::holds_alternative<Dense>(weights)) {
      JointLimits<N> sized{limits.lower, limits.upper, limits.velocity, limits.acceleration};
      sized.continuous = limits.continuous;
      return with(diagonal_weights<N>(dof), sized);
    }
  }
  return with(any_weights(*this, dof), limits);
}

template <typename Space>
EitherScheme<Space> Scheme::make(const AnyArmFor<Space>& arm) const {
  return std::visit(
      [&](auto scheme) -> EitherScheme<Space> {
        using Any = decltype(scheme);
        if (manipulability_gain != 0.0) scheme = Any(ManipulabilityAscent(scheme, arm, manipulability_gain));
        scheme.require_dof(arm.dof());
        return scheme;
      },
      plain<Space>(arm.limits()));
}

template EitherScheme<Position<2>> Scheme::plain(const JointLimits<kDynamic>&) const;
template EitherScheme<PlanarPose> Scheme::plain(const JointLimits<kDynamic>&) const;
template EitherScheme<Position<3>> Scheme::plain(const JointLimits<kDynamic>&) const;
template EitherScheme<Pose> Scheme::plain(const JointLimits<kDynamic>&) const;
template EitherScheme<Position<2>> Scheme::make(const AnyArm<Position<2>>&) const;
template EitherScheme<PlanarPose> Scheme::make(const AnyArm<Position<2>>&) const;
template EitherScheme<Position<3>> Scheme::make(const AnyArm<Position<3>>&) const;
template EitherScheme<Pose> Scheme::make(const AnyArm<Position<3>>&) const;

}  // namespace fpbm::bindings
