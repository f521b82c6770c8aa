#pragma once

#include <memory>

#include "arm.hpp"
#include "bounds.hpp"
#include "fpbm/any/any_stack.hpp"
#include "posture_solver.hpp"

namespace fpbm::bindings {

/// Solvers without lanes. Throw std::invalid_argument as fpbm::InverseKinematics does. Compiled once, in postures.cpp.
template <typename Space>
std::unique_ptr<PostureSolver<Space>> posture_solver(const AnyArmFor<Space>& arm, const InverseOptions<>& options,
                                                     const JointLimits<kDynamic>& limits);
std::unique_ptr<PostureSolver<AnyStack::Space>> posture_solver(const Tree<>& tree, const AnyStack& stack,
                                                               const InverseOptions<>& options,
                                                               const JointLimits<kDynamic>& limits,
                                                               const AnyBounds& bounds);

}  // namespace fpbm::bindings
