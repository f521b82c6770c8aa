#include "limiter.hpp"
#include "fpbm/limits/level_saturation.hpp"

namespace fpbm::bindings {

SaturatedMotion<kDynamic> limited_motion(const AnyLimiter& any, const Matrix<kDynamic, kDynamic>& J,
                                         const State<kDynamic>& state, const JointVector& desired,
                                         const JointVector& last, const LimiterRows& rows) {
  return std::visit([&](const auto& limiter) { return limiter.motion(J, state, desired, last, rows); }, any);
}

SaturatedMotion<kDynamic> braking_motion(const AnyLimiter& any, const State<kDynamic>& state, const JointVector& last) {
  return std::visit([&](const auto& limiter) { return limiter.brake(state, last); }, any);
}

Levels saturate(const std::vector<LevelRows>& levels, const Box<kDynamic>& box, const JointVector& rest,
                const JointVector& unit) {
  LevelSaturation<kDynamic> saturation(box, rest, unit);
  std::vector<double> scale;
  for (const auto& [J, b] : levels) scale.push_back(saturation.resolve(J, b));
  return {saturation.motion(), scale};
}

}  // namespace fpbm::bindings
