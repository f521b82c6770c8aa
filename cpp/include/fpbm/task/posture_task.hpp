#pragma once

#include <array>

#include "fpbm/geometry/detail/joint_space.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"

namespace fpbm {

/// Positions of all joints or of some joints.
template <int M, typename Scalar_ = double>
struct PostureTask {
  using Scalar = Scalar_;
  using Space = JointSpace<M>;
  static constexpr int kRows = M;
  static constexpr bool kWhole = true;

  TaskGains<Scalar> gains;
  std::array<int, M> joints = first_joints();  ///< Indices of the joints, from 0, each once.

  /// Index of the joint of a row.
  [[nodiscard]] int joint(int row) const noexcept { return joints[static_cast<std::size_t>(row)]; }

  template <typename Robot>
  void bind(const Robot& robot) const {
    require_different("joints", joints, robot.dof());
  }

  template <typename Robot, typename Rows>
  void evaluate([[maybe_unused]] const Robot& robot, const typename Robot::State& state, Vector<M, Scalar>& x,
                Vector<M, Scalar>& xd, Matrix<M, M, Scalar>& S, Rows level) const noexcept {
    for (int i = 0; i < M; ++i) {
      const int joint = joints[static_cast<std::size_t>(i)];
      x(i) = state.q(joint);
      xd(i) = state.qd(joint);
      level.set_unit(i, joint);
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
