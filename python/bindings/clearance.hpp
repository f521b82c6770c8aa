#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "arm.hpp"
#include "bounds.hpp"

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

/// The bounds of an arm from a sequence of fpbm_cpp.Clearance, at most one, and fpbm_cpp.TaskBounds. Throws
/// std::invalid_argument if a bound does not fit the arm.
AnyBounds bounds_of(const Model& model, const pybind11::object& given);

/// The clearance of an arm from an fpbm_cpp.Clearance. Throws std::invalid_argument if the clearance does not fit the
/// arm.
Clearance<kDynamic> clearance_of(const Model& model, const pybind11::handle& given);

/// The nearest checked pair of shapes in a posture; none if no pair is checked.
std::optional<PyNearest> nearest_at(const Clearance<kDynamic>& clearance, const JointVector& q);

/// Moves the obstacle of that name. Throws std::invalid_argument if no obstacle has that name, or if the shape has
/// another kind.
void move_obstacle(Clearance<kDynamic>& clearance, const std::string& name, const Shape& shape,
                   const Vector<3>& velocity);

}  // namespace fpbm::bindings
