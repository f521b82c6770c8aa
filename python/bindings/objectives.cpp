#include "objectives.hpp"

#include <stdexcept>
#include <type_traits>

#include "fpbm/objective/gaze.hpp"
#include "fpbm/objective/manipulability_ascent.hpp"
#include "fpbm/objective/second_task.hpp"

namespace fpbm::bindings {
namespace {

/// The scheme with a second task in its null space.
template <Level kLevel, typename Space>
[[nodiscard]] AnyScheme<kLevel, Space> with_second_task(const AnyScheme<kLevel, Space>& scheme,
                                                        const PySecondTask& task, const WholeArm<Space>& arm) {
  using Result = AnyScheme<kLevel, Space>;
  constexpr bool kInPlane = std::is_same_v<Space, Position<2>> || std::is_same_v<Space, PlanarPose>;
  const auto with = [&](const auto& second, const auto& point) {
    return Result(SecondTask(scheme, second, std::decay_t<decltype(point)>(point), task.k1, task.k2));
  };
  if constexpr (kInPlane) {
    if (const auto* given = std::get_if<PySecondTask::Point<Position<2>>>(&task.what)) {
      return with(AnyArm<Position<2>>(given->arm, given->dof), Reference<Position<2>>::hold(given->x));
    }
    throw std::invalid_argument("second_task: of an arm in the plane, it must be the tip of another one in the plane");
  } else {
    if (const auto* given = std::get_if<PySecondTask::Point<Position<3>>>(&task.what)) {
      return with(AnyArm<Position<3>>(given->arm, given->dof), Reference<Position<3>>::hold(given->x));
    }
    if (const auto* given = std::get_if<PySecondTask::Direction>(&task.what)) {
      return with(Gaze(AnyArm<Pose>(arm.poses, arm.dof()), given->d), Reference<Position<2>>::hold(Vector<2>::Zero()));
    }
    throw std::invalid_argument("second_task: of an arm in space, it must be the tip of another one in space");
  }
}

template <typename Space>
constexpr auto kErase = [](const auto& scheme) {
  return WholeScheme<Space>(AnyScheme<std::decay_t<decltype(scheme)>::kLevel, Space>(scheme));
};

}  // namespace

template <typename Space>
WholeScheme<Space> whole_scheme(const PyScheme& scheme, const WholeArm<Space>& arm) {
  WholeScheme<Space> result = scheme.visit_core<kDynamic>(arm.limits, kErase<Space>);
  std::visit(
      [&](auto& whole) {
        using Any = std::decay_t<decltype(whole)>;
        if (scheme.manipulability_gain != 0.0) {
          whole = Any(ManipulabilityAscent(whole, AnyArm<Space>(arm.model, arm.dof()), scheme.manipulability_gain));
        }
        if (scheme.second_task) whole = with_second_task(whole, *scheme.second_task, arm);
        whole.require_dof(arm.dof());
      },
      result);
  return result;
}

template <typename Space>
WholeScheme<Space> scheme_alone(const PyScheme& scheme, Eigen::Index dof) {
  return scheme.visit<kDynamic>(static_cast<int>(dof), kErase<Space>);
}

template WholeScheme<Position<2>> whole_scheme(const PyScheme&, const WholeArm<Position<2>>&);
template WholeScheme<Position<2>> scheme_alone(const PyScheme&, Eigen::Index);
template WholeScheme<PlanarPose> whole_scheme(const PyScheme&, const WholeArm<PlanarPose>&);
template WholeScheme<PlanarPose> scheme_alone(const PyScheme&, Eigen::Index);
template WholeScheme<Position<3>> whole_scheme(const PyScheme&, const WholeArm<Position<3>>&);
template WholeScheme<Position<3>> scheme_alone(const PyScheme&, Eigen::Index);
template WholeScheme<Pose> whole_scheme(const PyScheme&, const WholeArm<Pose>&);
template WholeScheme<Pose> scheme_alone(const PyScheme&, Eigen::Index);

}  // namespace fpbm::bindings
