#pragma once

#include "arrays.hpp"
#include "stack_tasks.hpp"

namespace fpbm::bindings {

/// An fpbm_cpp.Stack for a robot. Throws std::invalid_argument if a task does not suit the robot.
StackPlan read_stack(const py::object& stack, const Model& model);

/// The frame of a task of a frame.
LinkFrame<> read_frame(const py::handle& task, const Model& model);

/// A target of a task: x, or (x, xd, xdd) in a tuple. Throws std::invalid_argument if it has another shape.
StackTarget read_target(const StackTask& task, const py::handle& given);

}  // namespace fpbm::bindings
