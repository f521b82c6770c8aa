#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/stack_kinematics.hpp"

namespace fpbm {

/// Rows of the first task level, or Eigen::Dynamic.
template <typename Space, int N, typename Scalar>
inline constexpr int kRowsOfFirst =
    std::decay_t<decltype(first_rows(std::declval<const Kinematics<Space, N, Scalar>&>()))>::RowsAtCompileTime;

/// dJ/dt of the first task level.
template <typename Space, int N, typename Scalar>
[[nodiscard]] const auto& first_rates(const Kinematics<Space, N, Scalar>& kinematics) noexcept {
  return kinematics.Jd;
}
template <typename... Levels, int N, typename Scalar>
[[nodiscard]] const auto& first_rates(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics) noexcept {
  return std::get<0>(kinematics.levels).Jd;
}

/// A displacement or velocity in the rows of the first task level.
template <typename Space, int N, typename Scalar>
[[nodiscard]] const Vector<Space::kRows, Scalar>& twist_of_first(const Kinematics<Space, N, Scalar>&,
                                                                 const Vector<Space::kRows, Scalar>& twist) noexcept {
  return twist;
}
template <typename... Levels, int N, typename Scalar>
[[nodiscard]] auto twist_of_first(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics,
                                  const Vector<StackSpace<Levels...>::kRows, Scalar>& twist) noexcept {
  using Space = StackSpace<Levels...>;
  Vector<kRowsOfFirst<Space, N, Scalar>, Scalar> result;
  result.resize(first_rows(kinematics).rows());
  Eigen::Index to = 0;
  Space::each([&](auto space, auto i, int from) noexcept {
    if constexpr (static_cast<int>(decltype(i)::value) < Space::kFirst) {
      const auto& S = std::get<decltype(i)::value>(kinematics.tasks).S;
      if constexpr (std::tuple_element_t<decltype(i)::value, typename Stack<Levels...>::Tasks>::kWhole) {
        for (Eigen::Index j = 0; j < S.rows(); ++j) result(to + j) = S(j, j) * twist(from + j);
      } else {
        result.segment(to, S.rows()) = S.lazyProduct(twist.template segment<decltype(space)::kRows>(from));
      }
      to += S.rows();
    }
  });
  return result;
}

}  // namespace fpbm
