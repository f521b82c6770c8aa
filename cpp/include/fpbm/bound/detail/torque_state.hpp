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
    [[nodiscard]] Scalar at(Eigen::Index i, const JointVector& u) const noexcept {
      return h.coeff(i) + sum_over(u, [&](Eigen::Index j) { return M.coeff(j, i) * u.coeff(j); });
    }
  };

  /// Largest result of kept_part(): the next part is at most √9 times as long. A choice.
  static constexpr Scalar kMostKept = Scalar(9);

  State<N, Scalar> at;
  std::array<Torque, 2> of;
  std::size_t models = 1;

  /// count: number of models. Before set(), no state is equal or near.
  TorqueState(Eigen::Index dof, std::size_t count)
      : at{filled<JointVector>(dof, std::numeric_limits<Scalar>::quiet_NaN()), filled<JointVector>(dof)},
        models(count) {
    of.fill({filled<Matrix<N, N, Scalar>>(dof), filled<JointVector>(dof)});
  }

  [[nodiscard]] bool is_at(const State<N, Scalar>& state) const noexcept {
    for (Eigen::Index i = 0; i < at.q.size(); ++i) {
      if (!(at.q.coeff(i) == state.q.coeff(i) && at.qd.coeff(i) == state.qd.coeff(i))) return false;
    }
    return true;
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

  /// Largest f, at most kMostKept, with |τ_i| + f more_i ≤ most_i for all accelerations of a part, and, if the part
  /// ends at rest, for u = 0. Negative if |τ_i| exceeds most_i.
  template <typename Part>
  [[nodiscard]] Scalar kept_part(const JointVector& most, const Part& part, const JointVector& more,
                                 bool rests) const noexcept {
    Scalar kept(kMostKept);
    const bool zero = part.pauses || rests;
    for (std::size_t k = 0; k < models; ++k) {
      JointVector largest =
          entrywise(most, [&](Eigen::Index i) { return zero ? std::abs(of[k].h.coeff(i)) : Scalar(0); });
      for (std::size_t c = 0; c < part.corner_count; ++c) {
        const JointVector torque = of[k](part.corners[c]);
        for (Eigen::Index i = 0; i < most.size(); ++i) {
          largest.coeffRef(i) = std::max(largest.coeff(i), std::abs(torque.coeff(i)));
        }
      }
      each_joint(part.alone, [&](Eigen::Index j) noexcept {
        const Scalar half = (part.high.coeff(j) - part.low.coeff(j)) / Scalar(2);
        for (Eigen::Index i = 0; i < most.size(); ++i) largest.coeffRef(i) += std::abs(of[k].M.coeff(i, j)) * half;
      });
      for (Eigen::Index i = 0; i < most.size(); ++i) {
        const Scalar slack = most.coeff(i) - largest.coeff(i);
        if (more.coeff(i) * kept <= slack) continue;
        kept = slack / more.coeff(i);
        if (!(kept <= Scalar(kMostKept))) return -std::numeric_limits<Scalar>::infinity();  // Not a number.
      }
    }
    return kept;
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

  /// Whether a torque is at least more_i beyond most_i for the accelerations u.
  [[nodiscard]] bool exceeds(const JointVector& most, const JointVector& u, const JointVector& more) const noexcept {
    for (std::size_t k = 0; k < models; ++k) {
      const JointVector torque = of[k](u);
      for (Eigen::Index i = 0; i < torque.size(); ++i) {
        if (std::abs(torque.coeff(i)) > most.coeff(i) + more.coeff(i)) return true;
      }
    }
    return false;
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
