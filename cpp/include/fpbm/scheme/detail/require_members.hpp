#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/core/detail/has_member.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/scheme/detail/task_equation.hpp"

namespace fpbm {

/// Types of the members of a scheme (docs/architecture.md, Add a scheme).
template <typename Scheme>
using LevelOf = decltype(Scheme::kLevel);
template <typename Scheme>
using DofOf = decltype(Scheme::kDof);
template <typename Scheme>
using NullSpaceOf = decltype(Scheme::null_space);
template <typename Scheme>
using RequireDofOf = decltype(std::declval<const Scheme&>().require_dof(Eigen::Index()));
template <typename Scheme, typename Kinematics_, typename Reference_, typename State_, typename Motion>
using ResolveOf = decltype(std::declval<const Scheme&>().resolve(
    std::declval<const Kinematics_&>(), std::declval<const Reference_&>(), std::declval<const State_&>(),
    std::declval<Motion&>()));
template <typename Scheme, typename Task, typename State_, typename Motion>
using ResolveRowsOf = decltype(std::declval<const Scheme&>().resolve_rows(
    std::declval<const Task&>(), std::declval<const State_&>(), std::declval<Motion&>()));

template <typename Scheme>
using MovesAtRestOf = decltype(std::declval<const Scheme&>().moves_at_rest());

/// Whether the first level of a stack may have null-space motion at rest: the answer of the scheme, or whether its null
/// space depends on the posture.
template <typename Scheme>
[[nodiscard]] bool moves_at_rest(const Scheme& scheme) noexcept {
  if constexpr (kHas<Scheme, MovesAtRestOf>) {
    return scheme.moves_at_rest();
  } else {
    return scheme.null_space.template active<Level::kVelocity>();
  }
}

/// The members of every scheme. If a member is missing, the compiler prints a message. Always true.
template <typename Scheme, typename Space, int N, typename Scalar>
[[nodiscard]] constexpr bool require_members() noexcept {
  static_assert(
      kHas<Scheme, LevelOf>,
      "the scheme has no member `kLevel`: add `static constexpr fpbm::Level kLevel`, the level of its motion");
  static_assert(kHas<Scheme, DofOf>,
                "the scheme has no member `kDof`: add `static constexpr int kDof`, the number of joints or "
                "Eigen::Dynamic");
  static_assert(kHas<Scheme, RequireDofOf>,
                "the scheme has no member `require_dof`: add `void require_dof(Eigen::Index dof) const`, which throws "
                "std::invalid_argument if the scheme is for another number of joints");
  static_assert(kHas<Scheme, ResolveOf, Kinematics<Space, N, Scalar>, Reference<Space, Scalar>, State<N, Scalar>,
                     Vector<N, Scalar>>,
                "the scheme has no member `resolve` for this task and arm: add `template <typename Space> fpbm::Status "
                "resolve(const fpbm::Kinematics<Space, N>&, const fpbm::Reference<Space>&, const fpbm::State<N>&, "
                "fpbm::Vector<N>& u) const noexcept`");
  return true;
}

/// The additional members of the scheme of a stack, whose first level has M rows. Always true.
template <typename Scheme, int M, int N, typename Scalar>
[[nodiscard]] constexpr bool require_members_for_stack() noexcept {
  static_assert(kHas<Scheme, ResolveRowsOf, TaskEquation<M, N, Scalar>, State<N, Scalar>, Vector<N, Scalar>>,
                "the scheme of a stack has no member `resolve_rows`: add `template <int M> fpbm::Status resolve_rows("
                "const fpbm::TaskEquation<M, N>&, const fpbm::State<N>&, fpbm::Vector<N>& u) "
                "const noexcept`");
  static_assert(kHas<Scheme, NullSpaceOf>,
                "the scheme of a stack has no member `null_space`: add `fpbm::NullSpace<N> null_space`, the secondary "
                "motion, zero by default");
  return true;
}

}  // namespace fpbm
