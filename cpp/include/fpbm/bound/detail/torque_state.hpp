#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// Torques of a robot in one state, as functions of the accelerations u: τ = M u + h, for one or two models.
template <int N, typename Scalar = double>
struct TorqueState {
  using JointVector = Vector<N, Scalar>;

  struct Torque {
    Matrix<N, N, Scalar> M;
    JointVector h;

    [[nodiscard]] JointVector operator()(const JointVector& u) const noexcept {
      JointVector torque = product(M, u);
      for (Eigen::Index i = 0; i < torque.size(); ++i) torque.coeffRef(i) += h.coeff(i);
      return torque;
    }
  };

  State<N, Scalar> at;
  std::array<Torque, 2> of;
  std::size_t models = 1;

  /// count: number of models. Call set() before any other function.
  TorqueState(Eigen::Index dof, std::size_t count)
      : at{filled<JointVector>(dof, std::numeric_limits<Scalar>::quiet_NaN()), filled<JointVector>(dof)},
        models(count) {}

  [[nodiscard]] bool is_at(const State<N, Scalar>& state) const noexcept {
    return at.q == state.q && at.qd == state.qd;
  }

  /// Evaluates models in a state. Returns whether the state is another than before.
  template <typename Models, typename RobotState_>
  bool set(const Models& dynamics, const State<N, Scalar>& state, RobotState_& memory) noexcept {
    if (is_at(state)) return false;
    at = state;
    dynamics[0].robot().update(state.q, state.qd, memory);
    for (std::size_t k = 0; k < models; ++k) {
      of[k].h = dynamics[k].bias(memory);
      of[k].M = dynamics[k].mass_matrix(memory);
    }
    return true;
  }

  /// Largest f, at most 1, with |τ_i| + f more_i ≤ most_i for all accelerations from low to high. Negative if |τ_i|
  /// exceeds most_i.
  [[nodiscard]] Scalar kept_part(const JointVector& most, const JointVector& low, const JointVector& high,
                                 const JointVector& more) const noexcept {
    Scalar part(1);
    const auto middle = entrywise(low, [&](Eigen::Index i) { return (low.coeff(i) + high.coeff(i)) / Scalar(2); });
    for (std::size_t k = 0; k < models; ++k) {
      const JointVector torque = of[k](middle);
      for (Eigen::Index i = 0; i < torque.size(); ++i) {
        const Scalar spread = sum_over(low, [&](Eigen::Index j) {
          return std::abs(of[k].M.coeff(i, j)) * (high.coeff(j) - low.coeff(j)) / Scalar(2);
        });
        const Scalar slack = most.coeff(i) - std::abs(torque.coeff(i)) - spread;
        if (!(slack >= Scalar(0))) return Scalar(-1);
        if (more.coeff(i) * part > slack) part = slack / more.coeff(i);
      }
    }
    return part;
  }
  /// Whether |τ_i| ≤ most_i for the accelerations u.
  [[nodiscard]] bool keeps(const JointVector& most, const JointVector& u) const noexcept {
    for (std::size_t k = 0; k < models; ++k) {
      const JointVector torque = of[k](u);
      for (Eigen::Index i = 0; i < torque.size(); ++i) {
        if (!(std::abs(torque.coeff(i)) <= most.coeff(i))) return false;
      }
    }
    return true;
  }

  /// Largest fraction of the accelerations u, at most 1, with which |τ_i| ≤ most_i. 0 if there is none.
  [[nodiscard]] Scalar kept_fraction(const JointVector& most, const JointVector& u) const noexcept {
    Scalar fraction(1);
    for (std::size_t k = 0; k < models; ++k) {
      const JointVector torque = product(of[k].M, u);
      for (Eigen::Index i = 0; i < u.size(); ++i) {
        const Scalar h = torque.coeff(i) > Scalar(0) ? of[k].h.coeff(i) : -of[k].h.coeff(i);
        const Scalar slack = std::max(most.coeff(i) - h, Scalar(0));
        if (std::abs(torque.coeff(i)) * fraction > slack) fraction = slack / std::abs(torque.coeff(i));
      }
    }
    return fraction;
  }
};

}  // namespace fpbm
