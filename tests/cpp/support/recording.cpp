#include "support/recording.hpp"

namespace fpbm::test {

using Accelerations = AnyScheme<Level::kAcceleration, Position<2>>;
using Velocities = AnyScheme<Level::kVelocity, Position<2>>;

Accelerations erased(const AccelerationScheme<Eigen::Dynamic>& scheme) {
  return Accelerations(scheme);
}
Accelerations erased(const AccelerationScheme<Eigen::Dynamic, double, UnitWeights>& scheme) {
  return Accelerations(scheme);
}
Velocities erased(const VelocityScheme<Eigen::Dynamic>& scheme) {
  return Velocities(scheme);
}
Velocities erased(const VelocityScheme<Eigen::Dynamic, double, UnitWeights>& scheme) {
  return Velocities(scheme);
}

template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&, const AccelerationScheme<4>&,
                               const State<4>&, const TimeGrid<>&);
template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&,
                               const AccelerationScheme<4, double, UnitWeights>&, const State<4>&, const TimeGrid<>&);
template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&, const VelocityScheme<4>&,
                               const State<4>&, const TimeGrid<>&);
template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&,
                               const VelocityScheme<4, double, UnitWeights>&, const State<4>&, const TimeGrid<>&);
template Recording<7, double, Pose> recorded(const SerialArm<7>&, const AnyPath<Pose>&, const AccelerationScheme<7>&,
                                             const State<7>&, const TimeGrid<>&);

template Recording<Eigen::Dynamic> recorded(const AnyArm<Position<2>>&, const AnyPath<Position<2>>&,
                                            const AnyScheme<Level::kAcceleration, Position<2>>&,
                                            const State<Eigen::Dynamic>&, const TimeGrid<>&);
template Recording<Eigen::Dynamic> recorded(const AnyArm<Position<2>>&, const AnyPath<Position<2>>&,
                                            const AnyScheme<Level::kVelocity, Position<2>>&,
                                            const State<Eigen::Dynamic>&, const TimeGrid<>&);

}  // namespace fpbm::test
