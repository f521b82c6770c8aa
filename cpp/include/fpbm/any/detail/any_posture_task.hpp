#pragma once

#include <vector>

#include "fpbm/geometry/detail/joint_space.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"

namespace fpbm {

/// PostureTask for joints that are known at run time.
class AnyPostureTask {
 public:
  using Scalar = double;
  using Space = JointSpace<kMaxDof>;
  static constexpr int kRows = Eigen::Dynamic;
  static constexpr bool kWhole = true;

  TaskGains<> gains = TaskGains<>(0.0, 0.0);

  /// Empty task, without rows.
  AnyPostureTask() = default;

  /// joints: indices from 0, each once. Throws std::invalid_argument if there are no joints, or more than kMaxDof.
  AnyPostureTask(const std::vector<int>& joints, const TaskGains<>& gains_)
      : gains(gains_), count_(static_cast<int>(joints.size())) {
    if (count_ < 1 || count_ > kMaxDof) {
      validation::fail("number of joints", count_, "from 1 to ", kMaxDof);
    }
    for (int i = 0; i < count_; ++i) joints_(i) = joints[static_cast<std::size_t>(i)];
  }

  [[nodiscard]] int rows() const noexcept { return count_; }
  /// Index of the joint of a row.
  [[nodiscard]] int joint(int row) const noexcept { return joints_(row); }

  /// Throws std::invalid_argument if a joint does not exist in the robot, or is listed twice.
  template <typename Robot>
  void bind(const Robot& robot) const {
    require_different("joints", std::vector<int>(joints_.data(), joints_.data() + count_), robot.dof());
  }

  template <typename Robot, typename Rows>
  void evaluate([[maybe_unused]] const Robot& robot, const typename Robot::State& state, Vector<kMaxDof>& x,
                Vector<kMaxDof>& xd, Matrix<Eigen::Dynamic, kMaxDof>& S, Rows level) const noexcept {
    x = filled<Vector<kMaxDof>>(kMaxDof);
    S.resize(count_, kMaxDof);
    for (int i = 0; i < count_; ++i) {
      x(i) = state.q(joints_(i));
      xd(i) = state.qd(joints_(i));
      level.set_unit(i, joints_(i));
      S(i, i) = 1.0;
    }
  }

 private:
  int count_ = 0;
  Eigen::Matrix<int, kMaxDof, 1, Eigen::DontAlign> joints_ = Eigen::Matrix<int, kMaxDof, 1, Eigen::DontAlign>::Zero();
};

}  // namespace fpbm
