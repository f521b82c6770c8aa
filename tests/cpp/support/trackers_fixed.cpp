#include "support/compiled_tracker_members.hpp"
#include "support/panda_answers.hpp"

/// Arms of fixed size. The number of joints exceeds the number of task rows by one, by zero, and by more than one.
namespace fpbm::test {

template class CompiledTracker<SerialArm<7>, Pose, AccelerationScheme<7>>;
template class CompiledTracker<SerialArm<7>, Pose, VelocityScheme<7>>;
template class CompiledTracker<SerialArm<6>, Pose, AccelerationScheme<6>>;
template class CompiledTracker<PlanarArm<4>, Position<2>, AccelerationScheme<4>>;
template class CompiledTracker<PlanarArm<4>, Position<2>, VelocityScheme<4>>;
template Tick<Position<2>, 4> CompiledTracker<PlanarArm<4>, Position<2>, AccelerationScheme<4>>::tick(
    TargetFilter<Position<2>>&) noexcept;

Kinematics<Pose, 7> kinematics_of(const SerialArm<7>& arm, const State<7>& state) {
  Kinematics<Pose, 7> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  return kinematics;
}

Status resolve(const AccelerationScheme<7>& scheme, const Kinematics<Pose, 7>& kinematics,
               const Reference<Pose>& reference, const State<7>& state, Vector<7>& qdd) {
  return scheme.resolve(kinematics, reference, state, qdd);
}

}  // namespace fpbm::test
