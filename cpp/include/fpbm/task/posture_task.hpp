#pragma once

#include <array>

#include "fpbm/core/joint_space.hpp"
#include "fpbm/task/link_frame.hpp"
#include "fpbm/task/task_gains.hpp"

namespace fpbm {

/// Positions of M joints: all of them, or some.
template <int M, typename Scalar_ = double>
struct PostureTask {
  using Scalar = Scalar_;
  using Space = JointSpace<M>;
  static constexpr int kRows = M;
  static constexpr bool kWhole = true;

  TaskGains<Scalar> gains;
  std::array<int, M> joints = first_joints();  ///< Each once, from 0.

  template <typename Robot>
  void bind(const Robot& robot) const {
    require_different("joints", joints, robot.dof());
  }

  template <typename Robot>
  void evaluate(const Robot& robot, const typename Robot::State& state, Vector<M, Scalar>& x,
                Matrix<M, Robot::kDof, Scalar>& J, Matrix<M, Robot::kDof, Scalar>& Jd,
                Matrix<M, M, Scalar>& S) const noexcept {
    J.setZero(M, robot.dof());
    if (state.moves) Jd.setZero(M, robot.dof());
    for (int i = 0; i < M; ++i) {
      const int joint = joints[static_cast<std::size_t>(i)];
      x(i) = state.q(joint);
      J(i, joint) = Scalar(1);
    }
    S = identity<Matrix<M, M, Scalar>>();
  }

 private:
  [[nodiscard]] static std::array<int, M> first_joints() noexcept {
    std::array<int, M> joints{};
    for (int i = 0; i < M; ++i) joints[static_cast<std::size_t>(i)] = i;
    return joints;
  }
};

}  // namespace fpbm
