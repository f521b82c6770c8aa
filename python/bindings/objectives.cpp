#include "fpbm/objective/manipulability_ascent.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

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

template <typename Space>
EitherScheme<Space> Scheme::make_without_arm(Eigen::Index dof, JointBits continuous) const {
  if (needs_arm()) validation::reject("scheme", ": has objectives that need an arm: give an arm, not a Kinematics");
  auto limits = JointLimits<kDynamic>::none(dof);
  limits.continuous = continuous;
  return plain<Space>(limits);
}

template EitherScheme<Position<2>> Scheme::make(const AnyArm<Position<2>>&) const;
template EitherScheme<PlanarPose> Scheme::make(const AnyArm<Position<2>>&) const;
template EitherScheme<Position<3>> Scheme::make(const AnyArm<Position<3>>&) const;
template EitherScheme<Pose> Scheme::make(const AnyArm<Position<3>>&) const;
template EitherScheme<Position<2>> Scheme::make_without_arm(Eigen::Index, JointBits) const;
template EitherScheme<PlanarPose> Scheme::make_without_arm(Eigen::Index, JointBits) const;
template EitherScheme<Position<3>> Scheme::make_without_arm(Eigen::Index, JointBits) const;
template EitherScheme<Pose> Scheme::make_without_arm(Eigen::Index, JointBits) const;

}  // namespace fpbm::bindings
