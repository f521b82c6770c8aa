#include "support/recording.hpp"

namespace fpbm::test {

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

}  // namespace fpbm::test
