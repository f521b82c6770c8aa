#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "fpbm/limits/detail/task_levels.hpp"
#include "fpbm/realtime/detail/reference_sources.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/task/detail/stack_kinematics.hpp"

namespace fpbm {

/// Result of a tick of a stack. status, scale and sigma describe the first level, except that status is kSlowed if only
/// a lower level is slowed. error: x ⊖ f(q) of each task. A coordinate that a task does not select has no error
/// (task_error). A rotation error with free rotations near π is reduced (FrameSpace::turn_fraction()): at π, it is 0
/// although the target is not reached, and the scale of the level is below 1.
template <typename... Levels, int N, typename Scalar>
struct Tick<StackSpace<Levels...>, N, Scalar> : TickOfRows<StackSpace<Levels...>::kRows, N, Scalar> {
  /// Task scale of each level; 0 if a task of the level has stopped (LowerLevels) or has no finite reference. scales[0]
  /// is scale.
  std::array<Scalar, sizeof...(Levels)> scales{};
};

template <typename... Levels, int N, typename Scalar>
void multiply_scale(Tick<StackSpace<Levels...>, N, Scalar>& tick, Scalar factor) noexcept {
  tick.scale *= factor;
  for (Scalar& scale : tick.scales) scale *= factor;
}
template <typename... Levels, int N, typename Scalar, typename Motion>
void take_scale(Tick<StackSpace<Levels...>, N, Scalar>& tick, const Motion& motion) noexcept {
  tick.scale = motion.scale;
  tick.scales = motion.scales;
}

/// Whether a task space reduces errors with free rotations near π (FrameSpace::slowed_fraction()).
template <typename Space, typename = void>
inline constexpr bool kHasSlowedFraction = false;
template <typename Space>
inline constexpr bool kHasSlowedFraction<Space, std::void_t<typename Space::HasSlowedFraction>> = true;

/// Sets the scale to 0 for each level that was left out because a reference is not finite, and multiplies the scale of
/// a level by FrameSpace::slowed_fraction(). If a level is slowed or left out, the status is at least kSlowed. x:
/// targets.
template <typename... Levels, int N, typename Scalar>
void report_levels(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics,
                   const typename StackSpace<Levels...>::template Point<Scalar>& x,
                   Tick<StackSpace<Levels...>, N, Scalar>& tick) noexcept {
  StackSpace<Levels...>::each([&](auto space, auto i, int row) noexcept {
    using Part = decltype(space);
    constexpr std::size_t kTask = decltype(i)::value;
    constexpr int kIndex = Stack<Levels...>::level(static_cast<int>(kTask));
    for (int j = row; j < row + Part::kRows; ++j) {
      if (!std::isfinite(tick.error(j))) tick.scales[kIndex] = Scalar(0);
    }
    if constexpr (kHasSlowedFraction<Part>) {
      if (!kinematics.enabled[kIndex]) return;
      tick.scales[kIndex] *= Part::template slowed_fraction<Scalar>(std::get<kTask>(x), std::get<kTask>(kinematics.tip),
                                                                    std::get<kTask>(kinematics.tasks).S);
    }
  });
  tick.scale = tick.scales[0];
  for (const Scalar scale : tick.scales) {
    if (scale < Scalar(1)) tick.status = worse(tick.status, Status::kSlowed);
  }
}

template <typename... Levels, int N, typename Scalar>
[[nodiscard]] Scalar lower_scale(const Tick<StackSpace<Levels...>, N, Scalar>& tick, int row) noexcept {
  Scalar scale(1);
  StackSpace<Levels...>::each([&](auto, auto i, int first_row) noexcept {
    if (first_row == row) scale = tick.scales[Stack<Levels...>::level(static_cast<int>(decltype(i)::value))];
  });
  return scale;
}

/// Jacobians of the levels, for the limits. A level without lower levels is treated like one task: at the state of the
/// kinematics. Several levels keep the lead of continue_tick(): otherwise, limits of lower levels would disturb higher
/// levels at the end of the tick (Stack.keeps_its_first_level_while_lower_ones_are_limited).
template <typename... Levels, int N, typename Scalar>
[[nodiscard]] auto jacobian_in_metres(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics) noexcept {
  auto levels = std::apply(
      [&](const auto&... rows) {
        return TaskLevels<N, Scalar, std::decay_t<decltype(rows.matrix())>...>(kinematics.enabled, rows.matrix()...);
      },
      kinematics.levels);
  if (kinematics.tick > Scalar(0) && !has_lower_levels(kinematics)) {
    kinematics.each_task([&](auto level, const auto& task, Eigen::Index row) noexcept {
      constexpr std::size_t kIndex = decltype(level)::value;
      levels.template add_lead<kIndex>(row, task.S.rows(), -task.feedback.lead, std::get<kIndex>(kinematics.levels));
    });
  }
  return levels;
}

/// Reference of a stack, from a source for each task in the order of the stack.
template <typename... Levels, typename Scalar, typename... Sources>
[[nodiscard]] auto joined(StackSpace<Levels...>, Scalar seconds, const Sources&... sources) noexcept {
  using Space = StackSpace<Levels...>;
  if constexpr (sizeof...(Sources) == 1 && (std::is_same_v<Sources, Reference<Space, Scalar>> && ...)) {
    return ahead(sources..., seconds);
  } else {
    static_assert(sizeof...(Sources) == std::tuple_size_v<typename Space::template Point<Scalar>>,
                  "a tick of a stack needs a source of references for each task");
    const auto parts = std::make_tuple(source_ahead(sources, seconds)...);
    Reference<Space, Scalar> all = Reference<Space, Scalar>::hold(Space::template origin<Scalar>());
    Space::each([&](auto space, auto i, int row) noexcept {
      using Part = decltype(space);
      constexpr std::size_t kIndex = decltype(i)::value;
      std::get<kIndex>(all.x) = std::get<kIndex>(parts).x;
      all.xd.template segment<Part::kRows>(row) = std::get<kIndex>(parts).xd;
      all.xdd.template segment<Part::kRows>(row) = std::get<kIndex>(parts).xdd;
    });
    return all;
  }
}

}  // namespace fpbm
