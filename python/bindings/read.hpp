#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "arm.hpp"
#include "arrays.hpp"
#include "bounds.hpp"
#include "stack_tasks.hpp"

namespace fpbm::bindings {

/// The compiled part of a shape: an obstacle, or a capsule on a link.
struct Shape {
  WorldShape<> any;
  int link = 0;
};

/// Names, distance and nearest points of two shapes.
struct PyNearest {
  Clearance<kDynamic>::Names pair;
  double distance;
  Matrix<2, 3> points;
};

/// Bounds in words.
inline constexpr const char* kBoundsDemand = "a Clearance, TaskBounds and TorqueBounds in a sequence";

/// The bounds of an arm from a sequence of fpbm_cpp.Clearance, at most one, and fpbm_cpp.TaskBounds. Throws
/// std::invalid_argument if a bound does not fit the arm.
AnyBounds bounds_of(const Model& model, const pybind11::object& given);

/// The nearest checked pair of shapes in a posture; none if no pair is checked.
std::optional<PyNearest> nearest_at(const Clearance<kDynamic>& clearance, const JointVector& q);

/// Moves the obstacle of that name. Throws std::invalid_argument if no obstacle has that name, or if the shape has
/// another kind.
void move_obstacle(Clearance<kDynamic>& clearance, const std::string& name, const Shape& shape,
                   const Vector<3>& velocity);

/// The plan of an fpbm_cpp.Stack for a robot. Throws std::invalid_argument if a task does not fit the robot.
StackPlan read_stack(const py::object& stack, const Model& model);

/// The frame that a frame task moves.
LinkFrame<> read_frame(const py::handle& task, const Model& model);

/// A target of a task: x, or (x, xd, xdd) in a tuple. Throws std::invalid_argument if the shape is wrong.
StackTarget read_target(const StackTask& task, const py::handle& given);

}  // namespace fpbm::bindings
