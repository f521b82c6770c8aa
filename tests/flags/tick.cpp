#include <fpbm/fpbm.hpp>

/// Ticks of control loops in float, and nothing else, so that firmware.sh can look for arithmetic in double.
/// Of every kind of arm, task space and level, with the objective that is a scheme itself.
namespace fpbm {

using Serial = SerialArm<7, float>;
using Turning = WithRotation<InPlane<Path<Circle<float>>>>;

Tick<Pose, 7, float> tick(Tracker<Serial, Pose, AccelerationScheme<7, float>>& tracker,
                          PathFollower<Turning>& follower) {
  return tracker.tick(follower);
}

void pause(PathFollower<Turning>& follower) {
  follower.pause();
}

Tick<PlanarPose, 4, float> tick(Tracker<PlanarArm<4, float>, PlanarPose, VelocityScheme<4, float>>& tracker,
                                const Reference<PlanarPose, float>& reference) {
  return tracker.tick(reference);
}

Tick<Pose, 7, float> tick(Tracker<SerialArm<7, float>, Pose, AccelerationScheme<7, float>>& tracker,
                          TargetFilter<Pose, float>& filter) {
  return tracker.tick(filter);
}

Status resolve(const CoupledArm<6, float>& arm, const VelocityScheme<6, float>& scheme, const State<6, float>& state,
               const Reference<Position<3>, float>& reference, Vector<6, float>& qd) {
  Kinematics<Position<3>, 6, float> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  return scheme.resolve(kinematics, reference, state, qd);
}

Status resolve(const Kinematics<Position<3>, 7, float>& kinematics,
               const ManipulabilityAscent<AccelerationScheme<7, float>, Serial>& scheme, const State<7, float>& state,
               const Reference<Position<3>, float>& reference, Vector<7, float>& qdd) {
  return scheme.resolve(kinematics, reference, state, qdd);
}

}  // namespace fpbm
