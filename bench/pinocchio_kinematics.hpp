#pragma once

#include "pinocchio_arm.hpp"
#include "textbook.hpp"

namespace bench {

/// Tip, J and Jd by Pinocchio.
template <typename Case>
class PinocchioKinematics {
 public:
  static constexpr const char* kLibrary = "pinocchio";

  template <bool kWithRate>
  void move(const fpbm::State<Case::kDof>& state, Motion<Case>& motion) {
    constexpr int M = Case::kRows;
    q_ = state.q;
    if constexpr (kWithRate) qd_ = state.qd;
    const PinocchioArm::Motion& found = kWithRate ? arm_.move(q_, qd_) : arm_.move(q_);
    motion.R = found.R;
    motion.p = found.p;
    motion.J = found.J.topRows<M>();
    if constexpr (kWithRate) motion.Jd = found.Jd.topRows<M>();
  }

 private:
  PinocchioArm arm_{Case::Robot::chain()};
  Eigen::VectorXd q_;
  Eigen::VectorXd qd_;
};

}  // namespace bench
