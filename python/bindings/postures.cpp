#include "postures.hpp"

namespace fpbm::bindings {

template <typename Space>
std::unique_ptr<PostureSolver<Space>> posture_solver(const AnyArmFor<Space>& arm, const InverseOptions<>& options,
                                                     const JointLimits<kDynamic>& limits) {
  using Inverse = InverseKinematics<AnyArmFor<Space>, Space>;
  return std::make_unique<PostureSolverOf<Inverse, Space>>(Inverse(arm, Space{}, options, limits));
}

template <typename Space>
using Solver = std::unique_ptr<PostureSolver<Space>>;
using Limits_ = JointLimits<kDynamic>;
using Options = InverseOptions<>;
template Solver<Position<2>> posture_solver(const AnyArmFor<Position<2>>&, const Options&, const Limits_&);
template Solver<PlanarPose> posture_solver(const AnyArmFor<PlanarPose>&, const Options&, const Limits_&);
template Solver<Position<3>> posture_solver(const AnyArmFor<Position<3>>&, const Options&, const Limits_&);
template Solver<Pose> posture_solver(const AnyArmFor<Pose>&, const Options&, const Limits_&);

std::unique_ptr<PostureSolver<AnyStack::Space>> posture_solver(const Tree<>& tree, const AnyStack& stack,
                                                               const InverseOptions<>& options,
                                                               const JointLimits<kDynamic>& limits,
                                                               const AnyBounds& bounds) {
  using Tasks = RobotTasks<Robot<kDynamic>, AnyStack>;
  using Inverse = InverseKinematics<Tasks, AnyStack::Space, double, AnyBounds>;
  return std::make_unique<PostureSolverOf<Inverse, AnyStack::Space>>(
      Inverse(Robot<kDynamic>(tree), stack, options, limits, bounds));
}

}  // namespace fpbm::bindings
