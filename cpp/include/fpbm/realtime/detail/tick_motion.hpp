#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// Motion of the joints in a tick of a constant acceleration, or of a constant velocity at velocity level.
template <Level kLevel, int N, typename Scalar = double>
struct TickMotion {
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  static constexpr bool kSecondOrder = kLevel == Level::kAcceleration;

  Scalar dt;  ///< Length of the tick [s].

  /// Mean motion from one state to another.
  [[nodiscard]] JointVector between(const JointState& state, const JointState& next) const noexcept {
    return kSecondOrder ? rate(state.qd, next.qd) : next.qd;
  }

  /// State after a tick with the motion u.
  [[nodiscard]] JointState after(const JointState& state, const JointVector& u) const noexcept {
    if constexpr (kSecondOrder) return {moved(state, u), plus(state.qd, u, dt)};
    return {plus(state.q, u, dt), u};
  }

  /// Position after a tick of constant acceleration.
  [[nodiscard]] JointVector moved(const JointState& state, const JointVector& qdd) const noexcept {
    const Scalar half = dt / Scalar(2);
    return plus(state.q, entrywise(qdd, [&](Eigen::Index i) { return state.qd.coeff(i) + half * qdd.coeff(i); }), dt);
  }

  /// State in the middle of a tick of constant acceleration.
  [[nodiscard]] JointState middle(const JointState& state, const JointVector& qdd) const noexcept {
    const TickMotion half{dt / Scalar(2)};
    return {half.moved(state, qdd), plus(state.qd, qdd, half.dt)};
  }

  /// State in the middle of a tick of constant velocity.
  [[nodiscard]] JointState middle(const JointState& state) const noexcept {
    return {plus(state.q, state.qd, dt / Scalar(2)), state.qd};
  }

  /// (to − from)/dt.
  [[nodiscard]] JointVector rate(const JointVector& from, const JointVector& to) const noexcept {
    return entrywise(from, [&](Eigen::Index i) { return (to.coeff(i) - from.coeff(i)) / dt; });
  }

 private:
  /// from + seconds · change.
  [[nodiscard]] static JointVector plus(const JointVector& from, const JointVector& change, Scalar seconds) noexcept {
    return entrywise(from, [&](Eigen::Index i) { return from.coeff(i) + seconds * change.coeff(i); });
  }
};

}  // namespace fpbm
