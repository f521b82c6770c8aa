#pragma once

#include <utility>
#include <vector>

#include "arm.hpp"
#include "fpbm/limits/detail/box.hpp"

namespace fpbm::bindings {

/// J and b of a task J u = b.
using LevelRows = std::pair<Matrix<kDynamic, kDynamic>, JointVector>;

/// A motion of several levels, and the scale of each level.
struct Levels {
  JointVector u;
  std::vector<double> scale;
};

/// LevelSaturation of all levels. Compiled once, in a unit without pybind11.
Levels saturate(const std::vector<LevelRows>& levels, const Box<kDynamic>& box, const JointVector& rest,
                const JointVector& unit);

}  // namespace fpbm::bindings
