#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "arm.hpp"
#include "fpbm/clearance/clearance.hpp"

namespace fpbm::bindings {

/// The compiled part of a shape: in the world, or a capsule on a link.
struct Shape {
  WorldShape<> any;
  int link = 0;
};

/// Two shapes, by name, and how far they are apart.
struct PyNearest {
  Clearance<kDynamic>::Names pair;
  double distance;
};

/// The clearance of an arm from an fpbm_cpp.Clearance or None. Throws std::invalid_argument if it does not fit.
Clearance<kDynamic> clearance_of(const Model& model, const pybind11::object& given);

/// Adds bounds, a sequence of fpbm_cpp.TaskBounds. Throws std::invalid_argument if one does not suit the arm.
void add_bounds(Clearance<kDynamic>& clearance, const Model& model, const pybind11::object& bounds);

/// The pair of shapes nearest to one another in a posture; none where none is kept apart.
std::optional<PyNearest> nearest_at(const Clearance<kDynamic>& clearance, const JointVector& q);

/// Moves the obstacle of that name. Throws std::invalid_argument if there is none, or the shape is of another kind.
void move_obstacle(Clearance<kDynamic>& clearance, const std::string& name, const Shape& shape,
                   const Vector<3>& velocity);

}  // namespace fpbm::bindings
