#pragma once

#include <array>
#include <cmath>

#include "fpbm/linalg/detail/three.hpp"
#include "fpbm/model/detail/along_tree.hpp"
#include "fpbm/model/detail/physical_inertia.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// Constants of two joints and of the links that they move, relative to the placements of the joints.
///
/// With the principal moments I₁ ≤ I₂ ≤ I₃ and axes e, the rotational inertia about the centre of mass is μ1 − uuᵀ +
/// vvᵀ, with μ = I₂, u = √(I₂ − I₁) e₁ and v = √(I₃ − I₂) e₃. The second moments ∫ ρρᵀ dm about the centre of mass are
/// λ1 + uuᵀ − vvᵀ, with λ = (I₁ + I₃ − I₂)/2. Two vectors need fewer products to rotate than a matrix.
template <typename Scalar>
struct LinkPair {
  using Two = Pair<Scalar>;
  using Two3 = Three<Two>;

  Two turns = zero();  ///< 1 for a revolute joint, 0 for a prismatic joint.
  Two rotor_inertia = zero();
  Two viscous = zero();
  Two mass = zero();
  Two carried_mass = zero();  ///< Mass of the link and of all links that it carries [kg].
  Two mu = zero();
  Two twice_lambda = zero();
  Two3 centre{zero(), zero(), zero()};  ///< Centre of mass [m].
  Two3 u{zero(), zero(), zero()};       ///< [kg^½ m]
  Two3 v{zero(), zero(), zero()};       ///< [kg^½ m]

 private:
  [[nodiscard]] static Two zero() noexcept { return Two(Scalar(0)); }
};

/// Constants of all joints and links of a robot, in pairs, for newton_euler() and composite_inertia().
template <int N, typename Scalar, int Joints>
struct LinkPairs {
  using Pair_ = LinkPair<Scalar>;

  std::array<Pair_, static_cast<std::size_t>(kCapacity<Joints> + 1) / 2> pairs;
  Branches<Joints> branches;
  bool is_tree = false;  ///< Whether the robot has branches or prismatic joints.

  [[nodiscard]] const Pair_& operator[](std::size_t i) const noexcept { return pairs[i]; }

  /// Sets the constants of joint `link` − 1.
  void set_joint(const Robot<N, Scalar, Joints>& robot, int link, const JointDrive<Scalar>& drive) noexcept {
    const bool turns = robot.turns(link - 1);
    const int parent = robot.parent(link);
    set(link, &Pair_::turns, turns ? Scalar(1) : Scalar(0));
    set(link, &Pair_::rotor_inertia, drive.rotor_inertia);
    set(link, &Pair_::viscous, drive.viscous);
    branches.carriers[static_cast<std::size_t>(link - 1)] = parent;
    is_tree = is_tree || !turns || parent != link - 1;
    if (parent == link - 1) return;
    branches.starts |= joint_bit(link - 1);
    if (parent > 0) branches.forks |= joint_bit(parent - 1);
  }

  /// Sets the inertia of a link, and the mass that every link carries.
  void set_link(const Robot<N, Scalar, Joints>& robot, int link, const LinkInertia<Scalar>& inertia) noexcept {
    const auto [moments, axes] = PrincipalAxes<Scalar>(inertia.inertia);
    set(link, &Pair_::mass, inertia.mass);
    set(link, &Pair_::mu, moments(1));
    set(link, &Pair_::twice_lambda, moments(0) + moments(2) - moments(1));
    set(link, &Pair_::centre, Scalar(1), inertia.centre.data());
    set(link, &Pair_::u, std::sqrt(moments(1) - moments(0)), axes.data());
    set(link, &Pair_::v, std::sqrt(moments(2) - moments(1)), axes.data() + 6);
    // All sums again: differences of masses would accumulate round-off errors.
    for (int i = 1; i <= robot.joints(); ++i) set(i, &Pair_::carried_mass, get(i, &Pair_::mass));
    for (int i = robot.joints(); i > 0; --i) {
      const int parent = robot.parent(i);
      if (parent == 0) continue;
      set(parent, &Pair_::carried_mass, get(parent, &Pair_::carried_mass) + get(i, &Pair_::carried_mass));
    }
  }

 private:
  using Two = Pair<Scalar>;

  [[nodiscard]] Pair_& pair_of(int link) noexcept { return pairs[static_cast<std::size_t>(link - 1) / 2]; }
  static void set_one(Two& pair, int link, Scalar value) noexcept {
    pair = link % 2 == 0 ? Two(pair.first(), value) : Two(value, pair.second());
  }
  [[nodiscard]] Scalar get(int link, Two Pair_::*member) noexcept {
    const Two& pair = pair_of(link).*member;
    return link % 2 == 0 ? pair.second() : pair.first();
  }
  void set(int link, Two Pair_::*member, Scalar value) noexcept { set_one(pair_of(link).*member, link, value); }
  void set(int link, Three<Two> Pair_::*member, Scalar factor, const Scalar* vector) noexcept {
    Three<Two>& to = pair_of(link).*member;
    set_one(to.x, link, factor * vector[0]);
    set_one(to.y, link, factor * vector[1]);
    set_one(to.z, link, factor * vector[2]);
  }
};

/// Axes of the placements of joints i and i + 1 in the base frame.
template <typename Scalar>
struct AxesPair {
  using Two = Pair<Scalar>;
  Three<Two> x;
  Three<Two> y;
  Three<Two> z;

  template <typename State>
  [[gnu::always_inline]] AxesPair(const State& state, Eigen::Index i, Eigen::Index joints) noexcept
      : z(three(state.screws.joints(i).axis.data())) {
    const Scalar* const first = state.R[static_cast<std::size_t>(i + 1)].data();
    const Scalar* const second = state.R[static_cast<std::size_t>(i + 1 < joints ? i + 2 : i + 1)].data();
    x = three(first, second);
    y = three(first + 3, second + 3);
  }

  /// A vector relative to the placements, in the base frame.
  [[nodiscard, gnu::always_inline]] Three<Two> operator*(const Three<Two>& v) const noexcept {
    return v.x * x + v.y * y + v.z * z;
  }
};

}  // namespace fpbm
