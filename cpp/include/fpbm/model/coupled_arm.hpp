#pragma once

#include "fpbm/model/kinematics.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// Arm with a serial chain in which some joints follow other joints (gears, belts, URDF's mimic). N joints have a
/// drive, and any number of joints follow. Immutable.
template <int N, typename Scalar_ = double>
class CoupledArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// Throws std::invalid_argument under the conditions of Robot.
  template <int Length = Eigen::Dynamic>
  explicit CoupledArm(const Chain<Scalar, Length>& chain) : robot_(chain), tip_(robot_.in_joint(kTip, {})) {}

  [[nodiscard]] int dof() const noexcept { return robot_.dof(); }
  /// Bounds on the drives within which all joints of the chain, including followers, keep their bounds.
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return robot_.limits(); }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<3> and Pose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    typename Tree::State state;
    robot_.update(q, qd, state);
    set(state, out, out.Jd);
  }

  /// Tip and J at q. Jd does not change.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    typename Tree::State state;
    robot_.update(q, state);
    Matrix<Space::kRows, N, Scalar> zero;
    set(state, out, zero);
  }

 private:
  using Tree = Robot<N, Scalar, Eigen::Dynamic>;
  static constexpr int kTip = Tree::kTip;

  template <typename Space>
  void set(const typename Tree::State& state, Kinematics<Space, N, Scalar>& out,
           Matrix<Space::kRows, N, Scalar>& Jd) const noexcept {
    const Transform<Scalar> tip = robot_.frame(state, kTip, tip_);
    if constexpr (Space::kRows == 6) {
      out.tip = tip;
    } else {
      out.tip = tip.p;
    }
    out.length = robot_.length();
    robot_.jacobian(state, kTip, tip.p, out.J, Jd);
  }

  Tree robot_;
  Transform<Scalar> tip_;
};

}  // namespace fpbm
