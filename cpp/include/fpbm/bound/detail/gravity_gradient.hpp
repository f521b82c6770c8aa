#pragma once

#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// ∂g/∂q of the drives in a state, symmetric: the second derivative of the potential energy [Nm/rad].
///
/// If joint i moves the joint j with the axis z_j through p_j, which moves links of the mass m at c (sums over the
/// links), entry ij is −(z_i × (z_j × m (c − p_j))) · gravity.
template <int N, typename Scalar, int Joints>
[[nodiscard]] Matrix<N, N, Scalar> gravity_gradient(const Dynamics<N, Scalar, Joints>& model,
                                                    const RobotState<N, Scalar, Joints>& state) noexcept {
  using Vector3 = Vector<3, Scalar>;
  const auto& robot = model.robot();
  const int joints = robot.joints();
  Matrix<Joints, Joints, Scalar> gradient = filled<Matrix<Joints, Joints, Scalar>>(joints);
  std::array<Vector3, static_cast<std::size_t>(kCapacity<Joints>) + 1> moment;
  std::array<Scalar, static_cast<std::size_t>(kCapacity<Joints>) + 1> mass;
  for (int link = joints; link > 0; --link) {
    const auto k = static_cast<std::size_t>(link);
    const LinkInertia<Scalar>& body = model.link(link);
    const Vector3 c = times(state.R[k], body.centre);
    mass[k] = body.mass;
    for (int x = 0; x < 3; ++x) moment[k](x) = body.mass * (state.p[k](x) + c(x));
  }
  for (int link = joints; link > 0; --link) {
    const auto k = static_cast<std::size_t>(link);
    const auto carrier = static_cast<std::size_t>(robot.parent(link));
    const Vector3 z = column(state.R[k], 2);
    Vector3 moved;  // Derivative of the moment m c with respect to the joint.
    const Vector3 arm = entrywise(moment[k], [&](Eigen::Index x) { return moment[k](x) - mass[k] * state.p[k](x); });
    if (robot.turns(link - 1)) {
      moved = cross(z, arm);
    } else {
      for (int x = 0; x < 3; ++x) moved(x) = mass[k] * z(x);
    }
    each_joint(robot.moved_by(link), [&](Eigen::Index i) noexcept {
      if (!robot.turns(i)) return;
      const Vector3 change = cross(column(state.R[static_cast<std::size_t>(i) + 1], 2), moved);
      const Scalar entry =
          -sum_over(change, [&](Eigen::Index x) { return change.coeff(x) * model.gravity().coeff(x); });
      gradient(i, link - 1) = gradient(link - 1, i) = entry;
    });
    if (carrier == 0) continue;
    mass[carrier] += mass[k];
    for (int x = 0; x < 3; ++x) moment[carrier](x) += moment[k](x);
  }
  Matrix<N, N, Scalar> result = filled<Matrix<N, N, Scalar>>(robot.dof());
  for (Eigen::Index j = 0; j < joints; ++j) {
    Vector<Joints, Scalar> unit = filled<Vector<Joints, Scalar>>(joints);
    unit(j) = Scalar(1);
    const auto of_joint = robot.drives().by_drive(unit);
    Vector<Joints, Scalar> row = filled<Vector<Joints, Scalar>>(joints);
    for (Eigen::Index i = 0; i < joints; ++i) row(i) = gradient(j, i);
    const auto of_drives = robot.drives().by_drive(row);
    for (Eigen::Index a = 0; a < robot.dof(); ++a) {
      for (Eigen::Index b = 0; b < robot.dof(); ++b) result(a, b) += of_joint(a) * of_drives(b);
    }
  }
  return result;
}

}  // namespace fpbm
