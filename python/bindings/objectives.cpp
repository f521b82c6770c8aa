#include "fpbm/objective/gaze.hpp"
#include "fpbm/objective/manipulability_ascent.hpp"
#include "fpbm/objective/second_task.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {
namespace {

/// The scheme with a second task in its null space.
template <Level kLevel, typename Space>
[[nodiscard]] AnyScheme<kLevel, Space> with_second_task(const AnyScheme<kLevel, Space>& scheme,
                                                        const SecondTaskData& task, const AnyArmFor<Space>& arm) {
  const auto with = [&](const auto& second, const auto& point) {
    return AnyScheme<kLevel, Space>(SecondTask(scheme, second, point, task.k1, task.k2));
  };
  if constexpr (std::is_same_v<AnyArmFor<Space>, AnyArm<Position<2>>>) {
    if (const auto* given = std::get_if<SecondTaskData::Point<Position<2>>>(&task.what)) {
      return with(given->arm, Reference<Position<2>>::hold(given->x));
    }
    validation::reject("second_task", ": of an arm in the plane, it must be the tip of another one in the plane");
  } else {
    if (const auto* given = std::get_if<SecondTaskData::Point<Position<3>>>(&task.what)) {
      return with(given->arm, Reference<Position<3>>::hold(given->x));
    }
    if (const auto* given = std::get_if<SecondTaskData::Direction>(&task.what)) {
      return with(Gaze(arm, given->d), Reference<Position<2>>::hold(Vector<2>::Zero()));
    }
    validation::reject("second_task", ": of an arm in space, it must be the tip of another one in space");
  }
}

}  // namespace

template <typename Space>
EitherScheme<Space> Scheme::make(const AnyArmFor<Space>& arm) const {
  return std::visit(
      [&](auto scheme) -> EitherScheme<Space> {
        using Any = decltype(scheme);
        if (manipulability_gain != 0.0) scheme = Any(ManipulabilityAscent(scheme, arm, manipulability_gain));
        if (second_task) scheme = with_second_task(scheme, *second_task, arm);
        scheme.require_dof(arm.dof());
        return scheme;
      },
      plain<Space>(arm.limits()));
}

template <typename Space>
EitherScheme<Space> Scheme::make_without_arm(Eigen::Index dof) const {
  if (needs_arm()) validation::reject("scheme", ": it has objectives that need an arm, and there is none here");
  return plain<Space>(JointLimits<kDynamic>::none(dof));
}

template EitherScheme<Position<2>> Scheme::make(const AnyArm<Position<2>>&) const;
template EitherScheme<PlanarPose> Scheme::make(const AnyArm<Position<2>>&) const;
template EitherScheme<Position<3>> Scheme::make(const AnyArm<Position<3>>&) const;
template EitherScheme<Pose> Scheme::make(const AnyArm<Position<3>>&) const;
template EitherScheme<Position<2>> Scheme::make_without_arm(Eigen::Index) const;
template EitherScheme<PlanarPose> Scheme::make_without_arm(Eigen::Index) const;
template EitherScheme<Position<3>> Scheme::make_without_arm(Eigen::Index) const;
template EitherScheme<Pose> Scheme::make_without_arm(Eigen::Index) const;

}  // namespace fpbm::bindings
