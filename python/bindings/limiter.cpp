#include "limiter.hpp"

namespace fpbm::bindings {

SaturatedMotion<kDynamic> limited_motion(const AnyLimiter& any, const Matrix<kDynamic, kDynamic>& J,
                                         const State<kDynamic>& state, const JointVector& desired,
                                         const JointVector& last, const LimiterRows& rows) {
  return std::visit([&](const auto& limiter) { return limiter.motion(J, state, desired, last, rows); }, any);
}

SaturatedMotion<kDynamic> braking_motion(const AnyLimiter& any, const State<kDynamic>& state, const JointVector& last) {
  return std::visit([&](const auto& limiter) { return limiter.brake(state, last); }, any);
}

}  // namespace fpbm::bindings
