#pragma once

#include "fpbm/model/detail/along_tree.hpp"
#include "fpbm/model/detail/link_pairs.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// Torques of all joints at rest, ∂U/∂q. Joint i, with the axis z through p, moves links of the total mass m and the
/// first moment h = Σ m c. The torque is −(z × (h − m p)) · gravity, or −m z · gravity for a prismatic joint.
template <int N, typename Scalar, int Joints>
[[gnu::noinline]] void gravity_torques(const Robot<N, Scalar, Joints>& robot, const LinkPairs<N, Scalar, Joints>& links,
                                       const RobotState<N, Scalar, Joints>& state, const Vector<3, Scalar>& gravity,
                                       Vector<Joints, Scalar>& torques) noexcept {
  using Two = Pair<Scalar>;
  const Three<Two> lift{Two(-gravity.coeff(0)), Two(-gravity.coeff(1)), Two(-gravity.coeff(2))};
  const Eigen::Index n = robot.joints();
  torques.resize(n);
  AlongTree<1, true, Joints, Scalar> sums(links.branches);
  for (Eigen::Index i = 2 * ((n - 1) / 2); i >= 0; i -= 2) {
    const LinkPair<Scalar>& link = links[static_cast<std::size_t>(i / 2)];
    const AxesPair<Scalar> axes(state, i, n);
    const Three<Two> p = three(state.screws.joints(i).point.data());
    const Three<Two> h = sums.inward(i, {link.mass * (p + axes * link.centre)})[0];
    const Three<Two> turned = cross(axes.z, h - link.carried_mass * p);
    const Three<Two> slid = link.carried_mass * axes.z;
    set_two_of(torques, i, dot(lift, link.turns * turned + (Two(Scalar(1)) - link.turns) * slid));
  }
}

}  // namespace fpbm
