#pragma once

#include <array>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/model/detail/along_tree.hpp"
#include "fpbm/model/detail/link_pairs.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// Rows of all joints in the mass matrix by the composite-rigid-body algorithm: M_ij = sᵢ · (I_j s_j) for each joint i
/// that moves the link of joint j. s_j is the screw of joint j, and I_j is the spatial inertia of all links that joint
/// j moves, both at the origin of the base frame, so that inertias of links are added without transforms
/// (docs/dynamics.md). Two joints are computed in parallel.
///
/// kTree: for any tree; otherwise, for chains of revolute joints.
template <bool kTree, int N, typename Scalar, int Joints>
[[gnu::flatten, gnu::noinline]] void composite_inertia(const Robot<N, Scalar, Joints>& robot,
                                                       const LinkPairs<N, Scalar, Joints>& links,
                                                       const RobotState<N, Scalar, Joints>& state,
                                                       Matrix<Joints, Joints, Scalar>& M) noexcept {
  using Two = Pair<Scalar>;
  struct Screw {
    Three<Two> linear;
    Three<Two> angular;
  };
  constexpr auto kPairs = static_cast<std::size_t>(kCapacity<Joints> + 1) / 2;
  std::array<Screw, kPairs> screws;
  std::array<Screw, kPairs> momenta;
  const auto n = extent < kTree ? Eigen::Dynamic : Joints > (robot.joints());
  const auto pairs = pairs_of(n);
  const auto load = [](const auto& vector) noexcept { return three(vector.data()); };

  AlongTree<3, kTree, Joints, Scalar> sums(links.branches);
  each(Constant<0>{}, pairs, [&](auto pair) noexcept {
    const auto index = static_cast<std::size_t>(pairs - 1 - Eigen::Index(pair));
    const Eigen::Index i = 2 * static_cast<Eigen::Index>(index);
    const LinkPair<Scalar>& link = links[index];
    const AxesPair<Scalar> axes(state, i, n);
    const Three<Two> p = load(state.screws.joints(i).point);
    const Three<Two> centre = p + axes * link.centre;
    const Three<Two> u = axes * link.u;
    const Three<Two> v = axes * link.v;
    const Three<Two> moment = link.mass * centre;
    const Two xx = moment.x * centre.x;
    const Two yy = moment.y * centre.y;
    const Two zz = moment.z * centre.z;
    // The first moment, and the entries xx, yy, zz and yz, xz, xy of the rotational inertia.
    const auto [h, diagonal, product] =
        sums.inward(i, {moment,
                        {link.mu + (v.x * v.x - u.x * u.x) + (yy + zz), link.mu + (v.y * v.y - u.y * u.y) + (xx + zz),
                         link.mu + (v.z * v.z - u.z * u.z) + (xx + yy)},
                        {v.y * v.z - u.y * u.z - moment.y * centre.z, v.x * v.z - u.x * u.z - moment.x * centre.z,
                         v.x * v.y - u.x * u.y - moment.x * centre.y}});
    const Three<Two>& z = axes.z;
    Screw& s = screws[index];
    s = {cross(p, z), z};
    if constexpr (kTree) {
      s.linear = link.turns * s.linear + (Two(Scalar(1)) - link.turns) * z;
      s.angular = link.turns * z;
    }
    const auto& [linear, w] = s;
    momenta[index].linear = link.carried_mass * linear + cross(w, h);
    momenta[index].angular = cross(h, linear) + Three<Two>{diagonal.x * w.x + product.z * w.y + product.y * w.z,
                                                           product.z * w.x + diagonal.y * w.y + product.x * w.z,
                                                           product.y * w.x + product.x * w.y + diagonal.z * w.z};
  });

  M.resize(robot.joints(), robot.joints());
  if constexpr (kTree) {
    for (Eigen::Index i = 0; i < M.size(); ++i) M.coeffRef(i) = Scalar(0);
  }
  each(Constant<0>{}, n, [&](auto column) noexcept {
    const Eigen::Index j = Eigen::Index(column);
    const auto both = [&](const Two& one) noexcept { return Two(j % 2 == 0 ? one.first() : one.second()); };
    const auto both3 = [&](const Three<Two>& one) noexcept -> Three<Two> {
      return {both(one.x), both(one.y), both(one.z)};
    };
    const Screw& momentum = momenta[static_cast<std::size_t>(j / 2)];
    const Three<Two> linear = both3(momentum.linear);
    const Three<Two> angular = both3(momentum.angular);
    const JointBits moving = kTree ? robot.moved_by(static_cast<int>(j) + 1) : joint_bit(j) | (joint_bit(j) - 1);
    Scalar* const to = &M.coeffRef(0, j);
    for (Eigen::Index i = 0; i <= j; i += 2) {
      const JointBits pair = moving >> i & 3U;
      if (pair == 0) continue;
      const Screw& s = screws[static_cast<std::size_t>(i / 2)];
      const Two entries = dot(s.linear, linear) + dot(s.angular, angular);
      if (pair == 3) {
        entries.store(to + i);
        M.coeffRef(j, i) = entries.first();
        M.coeffRef(j, i + 1) = entries.second();
      } else if (pair == 1) {
        to[i] = M.coeffRef(j, i) = entries.first();
      } else {
        to[i + 1] = M.coeffRef(j, i + 1) = entries.second();
      }
    }
    const Two& rotor = links[static_cast<std::size_t>(j / 2)].rotor_inertia;
    to[j] += j % 2 == 0 ? rotor.first() : rotor.second();
  });
}

}  // namespace fpbm
