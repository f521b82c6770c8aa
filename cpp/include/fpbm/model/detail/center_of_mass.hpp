#pragma once

#include <array>

#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// Throws std::invalid_argument if a robot has no mass.
template <typename Robot>
void require_mass(const Robot& robot) {
  for (int link = 0; link <= robot.joints(); ++link) {
    if (robot.mass(link).mass > 0) return;
  }
  validation::reject("robot", " has no mass: give the mass of at least one link");
}

/// Computes the centre of mass of a robot, base included [m], and the velocity [m/s], J and J̇ of the centre of mass,
/// along the axes of the base frame.
///
/// The links have masses m_k at c_k, and m = Σ m_k. Joint i moves links of the total mass M_i and the mass moment
/// s_i = Σ m_k c_k. Column i of J is z × (s_i − M_i p_i)/m for a revolute joint with the axis z through p_i. For a
/// prismatic joint along z, column i is z M_i/m. J̇ is the derivative of J, with ż = w × z, where w is the angular
/// velocity of link i + 1 (docs/kinematics.md, Time derivative of J).
template <int N, typename Scalar, int Joints>
void center_of_mass(const Robot<N, Scalar, Joints>& robot, const RobotState<N, Scalar, Joints>& state,
                    Vector<3, Scalar>& centre, Vector<3, Scalar>& velocity, Matrix<3, N, Scalar>& J,
                    Matrix<3, N, Scalar>& Jd) noexcept {
  using Vector3 = Vector<3, Scalar>;
  struct Sums {
    Scalar mass;       ///< Mass of a link and of all links that it carries [kg].
    Vector3 moment;    ///< Σ m c [kg m]
    Vector3 momentum;  ///< Σ m ċ [kg m/s]
    Vector3 v;         ///< Velocity of the origin of the placement of the link [m/s].
  };
  const auto plus = [](const Vector3& a, Scalar factor, const Vector3& b) noexcept {
    return entrywise(a, [&](Eigen::Index i) { return a.coeff(i) + factor * b.coeff(i); });
  };
  std::array<Sums, static_cast<std::size_t>(kCapacity<Joints>) + 1> sums;
  const auto joints = static_cast<std::size_t>(robot.joints());
  const auto& rates = robot.joint_rates(state);
  for (std::size_t i = 0; i <= joints; ++i) {
    const int link = static_cast<int>(i);
    Sums& own = sums[i];
    own.v = filled<Vector3>(3);
    if (i > 0) {
      const auto parent = static_cast<std::size_t>(robot.parent(link));
      const Vector3 lever = plus(state.p[i], Scalar(-1), state.p[parent]);
      own.v = plus(sums[parent].v, Scalar(1), cross(robot.angular_velocity(state, robot.parent(link)), lever));
      if (!robot.turns(link - 1)) own.v = plus(own.v, rates.coeff(link - 1), column(state.R[i], 2));
    }
    const auto& [mass, seen] = robot.mass(link);
    const Vector3 offset = times(state.R[i], seen);
    const Vector3 moving = plus(own.v, Scalar(1), cross(robot.angular_velocity(state, link), offset));
    own.mass = mass;
    for (int k = 0; k < 3; ++k) {
      own.moment.coeffRef(k) = mass * (state.p[i].coeff(k) + offset.coeff(k));
      own.momentum.coeffRef(k) = mass * moving.coeff(k);
    }
  }
  for (std::size_t i = joints; i > 0; --i) {
    Sums& carrier = sums[static_cast<std::size_t>(robot.parent(static_cast<int>(i)))];
    carrier.mass += sums[i].mass;
    carrier.moment = plus(carrier.moment, Scalar(1), sums[i].moment);
    carrier.momentum = plus(carrier.momentum, Scalar(1), sums[i].momentum);
  }
  const Scalar inverse_mass = Scalar(1) / sums[0].mass;
  centre = entrywise(sums[0].moment, [&](Eigen::Index k) { return inverse_mass * sums[0].moment.coeff(k); });
  velocity = entrywise(sums[0].momentum, [&](Eigen::Index k) { return inverse_mass * sums[0].momentum.coeff(k); });
  Matrix<3, Joints, Scalar> columns;
  Matrix<3, Joints, Scalar> column_rates;
  columns.resize(3, robot.joints());
  column_rates.resize(3, robot.joints());
  for (std::size_t i = 1; i <= joints; ++i) {
    const int link = static_cast<int>(i);
    const auto& [mass, moment, momentum, v] = sums[i];
    const Vector3 z = column(state.R[i], 2);
    const Vector3 zd = cross(robot.angular_velocity(state, link), z);
    Vector3 column_of_joint = z;
    Vector3 column_rate = zd;
    Scalar factor = inverse_mass * mass;
    if (robot.turns(link - 1)) {
      const Vector3 lever = plus(moment, -mass, state.p[i]);
      column_of_joint = cross(z, lever);
      column_rate = plus(cross(zd, lever), Scalar(1), cross(z, plus(momentum, -mass, v)));
      factor = inverse_mass;
    }
    for (int k = 0; k < 3; ++k) {
      columns.coeffRef(k, link - 1) = factor * column_of_joint.coeff(k);
      column_rates.coeffRef(k, link - 1) = state.moves ? factor * column_rate.coeff(k) : Scalar(0);
    }
  }
  robot.drives().set_by_drive(columns, J);
  robot.drives().set_by_drive(column_rates, Jd);
}

}  // namespace fpbm
