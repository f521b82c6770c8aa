#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "arm.hpp"
#include "bounds.hpp"
#include "fpbm/limits/detail/box.hpp"
#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/limiter.hpp"

namespace fpbm::bindings {

/// fpbm::Limiter at acceleration level or at velocity level.
using AnyLimiter = std::variant<Limiter<Level::kAcceleration, kDynamic>, Limiter<Level::kVelocity, kDynamic>>;

/// Largest number of further bounds on motions, equal to the number of the bounds of a tracker, so that trackers and
/// limiters share compiled code.
inline constexpr int kLimiterRows = AnyBounds::kRows;
using LimiterRows = Rows<kDynamic, kLimiterRows>;

/// Limiter::motion() and Limiter::brake(). Compiled once, in the unit of the trackers.
SaturatedMotion<kDynamic> limited_motion(const AnyLimiter& any, const Matrix<kDynamic, kDynamic>& J,
                                         const State<kDynamic>& state, const JointVector& desired,
                                         const JointVector& last, const LimiterRows& rows);
SaturatedMotion<kDynamic> braking_motion(const AnyLimiter& any, const State<kDynamic>& state, const JointVector& last);

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
