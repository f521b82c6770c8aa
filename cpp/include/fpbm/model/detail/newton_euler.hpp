#pragma once

#include <array>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/model/detail/along_tree.hpp"
#include "fpbm/model/detail/link_pairs.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// A = [ẇ]× + [w]×[w]×, by rows: a point of a link at the distance r from another point has the additional acceleration
/// A r.
template <typename Value>
struct AngularMotion {
  Three<Value> x;
  Three<Value> y;
  Three<Value> z;

  [[gnu::always_inline]] AngularMotion(const Three<Value>& w, const Three<Value>& wd) noexcept {
    const Value xx = w.x * w.x;
    const Value yy = w.y * w.y;
    const Value zz = w.z * w.z;
    const Value xy = w.x * w.y;
    const Value xz = w.x * w.z;
    const Value yz = w.y * w.z;
    const Value all = xx + yy + zz;
    x = {xx - all, xy - wd.z, xz + wd.y};
    y = {xy + wd.z, yy - all, yz - wd.x};
    z = {xz - wd.y, yz + wd.x, zz - all};
  }

  [[nodiscard, gnu::always_inline]] Three<Value> operator*(const Three<Value>& r) const noexcept {
    return {dot(x, r), dot(y, r), dot(z, r)};
  }
};

/// Torques of all joints by the recursive Newton-Euler algorithm: the motion of the links from the base to the tips,
/// then the forces from the tips to the base (docs/dynamics.md). Two joints are computed in parallel.
///
/// kTree: for any tree; otherwise, for chains of revolute joints. accelerations: of all joints.
template <bool kTree, int N, typename Scalar, int Joints>
[[gnu::flatten, gnu::noinline]] void newton_euler(const Robot<N, Scalar, Joints>& robot,
                                                  const LinkPairs<N, Scalar, Joints>& links,
                                                  const RobotState<N, Scalar, Joints>& state,
                                                  const Vector<Joints, Scalar>& accelerations,
                                                  const Vector<3, Scalar>& gravity,
                                                  Vector<Joints, Scalar>& torques) noexcept {
  using Two = Pair<Scalar>;
  struct Force {
    Three<Two> f;  ///< [N]
    Three<Two> n;  ///< About the origin of the base frame [Nm].
  };
  constexpr auto kPairs = static_cast<std::size_t>(kCapacity<Joints> + 1) / 2;
  std::array<Force, kPairs> forces;
  const Three<Scalar> zero{Scalar(0), Scalar(0), Scalar(0)};
  const Vector<Joints, Scalar>& rates = robot.joint_rates(state);
  const auto n = extent < kTree ? Eigen::Dynamic : Joints > (robot.joints());
  const auto pairs = pairs_of(n);
  const auto load = [](const auto& vector) noexcept { return three(vector.data()); };

  AlongTree<1, kTree, Joints, Scalar> angular(links.branches, {zero});
  AlongTree<1, kTree, Joints, Scalar> linear(links.branches,
                                             {Three<Scalar>{-gravity.coeff(0), -gravity.coeff(1), -gravity.coeff(2)}});
  AlongTree<4, kTree, Joints, Scalar> carriers(links.branches, {zero, zero, zero, zero});
  each(Constant<0>{}, pairs, [&](auto pair) noexcept {
    const Eigen::Index i = 2 * Eigen::Index(pair);
    const LinkPair<Scalar>& link = links[static_cast<std::size_t>(pair)];
    const auto& joints = state.screws.joints(i);
    const AxesPair<Scalar> axes(state, i, n);
    const Three<Two> p = load(joints.point);
    const Three<Two> w = load(joints.w);
    const Two rate = two_of(rates, i);
    const Two acceleration = two_of(accelerations, i);

    const Three<Two> carried = rate * cross(w, axes.z);
    const Three<Two> driven = acceleration * axes.z;
    const Three<Two> wd = angular.outward(i, {kTree ? link.turns * (driven + carried) : driven + carried})[0];
    const AngularMotion<Two> A(w, wd);
    const auto [x, y, z, origin] = carriers.of_carriers(i, {A.x, A.y, A.z, p});
    const Three<Two> r = p - origin;
    Three<Two> added{dot(x, r), dot(y, r), dot(z, r)};
    if constexpr (kTree) added = added + (Two(Scalar(1)) - link.turns) * (driven + carried + carried);
    const Three<Two> a = linear.outward(i, {added})[0];

    const Three<Two> to_centre = axes * link.centre;
    const Three<Two> u = axes * link.u;
    const Three<Two> v = axes * link.v;
    Force& force = forces[static_cast<std::size_t>(pair)];
    force.f = link.mass * (a + A * to_centre);
    force.n = cross(p + to_centre, force.f) + link.twice_lambda * wd + (cross(u, A * u) - cross(v, A * v));
  });

  torques.resize(robot.joints());
  AlongTree<2, kTree, Joints, Scalar> sums(links.branches);
  each(Constant<0>{}, pairs, [&](auto pair) noexcept {
    const auto k = static_cast<std::size_t>(pairs - 1 - Eigen::Index(pair));
    const Eigen::Index i = 2 * static_cast<Eigen::Index>(k);
    const LinkPair<Scalar>& link = links[k];
    const auto& joints = state.screws.joints(i);
    const Three<Two> z = load(joints.axis);
    const auto [f, about_origin] = sums.inward(i, {forces[k].f, forces[k].n});
    const Three<Two> moment = about_origin - cross(load(joints.point), f);
    const Two torque = kTree ? dot(z, link.turns * moment + (Two(Scalar(1)) - link.turns) * f) : dot(z, moment);
    set_two_of(torques, i, torque + link.rotor_inertia * two_of(accelerations, i) + link.viscous * two_of(rates, i));
  });
}

}  // namespace fpbm
