#pragma once

#include <array>
#include <cstddef>
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

/// Bound on the growth of an error in the rows of the first task level that is due to the motion of the selected axes
/// since the last call: for a selection S of some rows along moving axes, d|S e|/dt contains dS/dt e. 0 without a
/// stack.
template <typename Space, int N, typename Scalar>
struct SelectionGrowth {
  [[nodiscard]] static Scalar of_error(const Kinematics<Space, N, Scalar>&,
                                       const Vector<Space::kRows, Scalar>&) noexcept {
    return Scalar(0);
  }
  [[nodiscard]] static Scalar of_rate(const Kinematics<Space, N, Scalar>&,
                                      const Vector<Space::kRows, Scalar>&) noexcept {
    return Scalar(0);
  }
};
template <typename... Levels, int N, typename Scalar>
struct SelectionGrowth<StackSpace<Levels...>, N, Scalar> {
  using Space = StackSpace<Levels...>;
  using Twist = Vector<Space::kRows, Scalar>;
  using Tasks = typename Stack<Levels...>::Tasks;
  using State = Kinematics<Space, N, Scalar>;

  /// error: x ⊖ f(q) of each task.
  [[nodiscard]] Scalar of_error(const State& kinematics, const Twist& error) noexcept {
    return growth(kinematics,
                  [&](const auto&, int row, auto rows) { return error.template segment<rows>(row).norm(); });
  }
  /// xd: desired velocity of each task.
  [[nodiscard]] Scalar of_rate(const State& kinematics, const Twist& xd) noexcept {
    return growth(kinematics, [&](const auto& task, int row, auto rows) {
      return (xd.template segment<rows>(row) - task.xd).norm();
    });
  }

 private:
  template <typename Size>
  [[nodiscard]] Scalar growth(const State& kinematics, Size&& size_of) noexcept {
    Scalar sum(0);
    Space::each([&](auto space, auto i, int row) noexcept {
      constexpr std::size_t kTask = decltype(i)::value;
      // The selection of a posture is constant.
      if constexpr (static_cast<int>(kTask) < Space::kFirst && !std::tuple_element_t<kTask, Tasks>::kWhole) {
        const auto& task = std::get<kTask>(kinematics.tasks);
        if (task.S.rows() == 0) return;  // An empty place of a stack has no velocity.
        const Scalar size = size_of(task, row, std::integral_constant<int, decltype(space)::kRows>{});
        auto& last = std::get<kTask>(last_).S;
        if (started_) sum += (task.S - last).norm() * (size + sizes_[kTask]);
        last = task.S;
        sizes_[kTask] = size;
      }
    });
    started_ = true;
    return sum;
  }

  bool started_ = false;
  typename stack_detail::StatesOf<Tasks>::type last_;  ///< Only S is used.
  std::array<Scalar, static_cast<std::size_t>(Space::kFirst)> sizes_{};
};

}  // namespace fpbm
