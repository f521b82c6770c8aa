#pragma once

#include "arrays.hpp"
#include "stack_tasks.hpp"

namespace fpbm::bindings {

/// An fpbm_cpp.Stack for an arm. Throws std::invalid_argument where a task does not suit the arm.
StackPlan read_stack(const py::object& stack, const Arm& arm);

/// The frame of a task of a frame.
LinkFrame<> read_frame(const py::handle& task, const Arm& arm);

/// A target of a task: x, or (x, xd, xdd) in a tuple. Throws std::invalid_argument where it has another shape.
StackTarget read_target(const StackTask& task, const py::handle& given);

}  // namespace fpbm::bindings
