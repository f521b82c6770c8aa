#pragma once

#include "arrays.hpp"
#include "stack_tasks.hpp"

namespace fpbm::bindings {

/// The plan of an fpbm_cpp.Stack for a robot. Throws std::invalid_argument if a task does not fit the robot.
StackPlan read_stack(const py::object& stack, const Model& model);

/// The frame that a frame task moves.
LinkFrame<> read_frame(const py::handle& task, const Model& model);

/// A target of a task: x, or (x, xd, xdd) in a tuple. Throws std::invalid_argument if the shape is wrong.
StackTarget read_target(const StackTask& task, const py::handle& given);

}  // namespace fpbm::bindings
