#pragma once

#include <Eigen/Geometry>

#include "stack_pinocchio.hpp"
#include "stack_step.hpp"

namespace bench::stack {

/// Rows and commands of the levels, b without J̇ q̇.
template <typename Case>
class CascadeLevels {
 public:
  static constexpr int M0 = Case::kRows;
  static constexpr int M1 = Case::kElbowRows;
  Eigen::Matrix<double, M0, N> J0;
  Eigen::Matrix<double, M0, 1> b0;
  Eigen::Matrix<double, M1, N> J1;
  Eigen::Matrix<double, M1, 1> b1;
  Joints b2;

  void update(const Asked<Case>& asked) {
    const Joints& qd = asked.state.qd;
    arm_.move(asked.state.q, qd);
    const auto& [x, xd, xdd] = asked.reference;
    const auto& tip = arm_.tip();
    J0 = tip.J.template topRows<M0>();
    b0 = xdd.template head<M0>() + kK1 * (xd.template head<M0>() - J0 * qd) + kK2 * error(std::get<0>(x)) -
         tip.drift.template head<M0>();
    constexpr int kFirst = 3 - M1;  // All coordinates, or z.
    const auto& elbow = arm_.elbow();
    J1 = elbow.J.template middleRows<M1>(kFirst);
    b1 = xdd.template segment<M1>(M0 + kFirst) + kK1 * (xd.template segment<M1>(M0 + kFirst) - J1 * qd) +
         kK2 * (std::get<1>(x) - elbow.p).template tail<M1>() - elbow.drift.template segment<M1>(kFirst);
    b2 = xdd.template tail<N>() + kPosture1 * (xd.template tail<N>() - qd) +
         kPosture2 * (std::get<2>(x) - asked.state.q);
  }

 private:
  Eigen::Vector3d error(const Eigen::Vector3d& x) const { return x - arm_.tip().p; }
  Eigen::Matrix<double, 6, 1> error(const fpbm::Transform<>& x) const {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(x.R * arm_.tip().R.transpose()));
    return (Eigen::Matrix<double, 6, 1>() << x.p - arm_.tip().p, turn.angle() * turn.axis()).finished();
  }

  StackPinocchio arm_{chain()};
};

}  // namespace bench::stack
