#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/limits/detail/one_level.hpp"
#include "fpbm/limits/detail/saturated_motion.hpp"
#include "fpbm/linalg/detail/diagonal_level.hpp"

namespace fpbm {

/// Jacobians of task levels in the order of priority: J₁ (M₁ × n) … J_K (M_K × n), all rows in metres. Each Jacobian is
/// a Matrix<M, N, Scalar>, or a DiagonalLevel below the first level.
template <int N, typename Scalar, typename... Matrices>
class TaskLevels {
 public:
  explicit TaskLevels(const Matrices&... J) noexcept : J_(J...) { enabled_.fill(true); }
  /// enabled: whether each level is enabled. Levels that are not enabled, or have no rows, are left out. The first
  /// level must be enabled.
  explicit TaskLevels(const std::array<bool, sizeof...(Matrices)>& enabled, const Matrices&... J) noexcept
      : enabled_(enabled), J_(J...) {}

  [[nodiscard]] const auto& first() const noexcept { return std::get<0>(J_); }
  /// Sets the desired motion of the first level alone, without lower levels. The first level is then limited as if
  /// there were no lower levels. `motion` must outlive this object.
  void set_first_motion(const Vector<N, Scalar>& motion) noexcept { first_motion_ = &motion; }
  /// Desired motion of the first level alone. By default, the desired motion of all levels.
  [[nodiscard]] const Vector<N, Scalar>& first_motion(const Vector<N, Scalar>& desired) const noexcept {
    return first_motion_ != nullptr ? *first_motion_ : desired;
  }
  /// Leaves out all levels below the first level.
  void disable_lower() noexcept {
    enabled_.fill(false);
    first_motion_ = nullptr;
  }

  /// Adds lead J̇ to rows first … first + count − 1 of J_k. A posture (DiagonalLevel) has J̇ = 0.
  template <std::size_t k, typename Rates>
  void add_lead([[maybe_unused]] Eigen::Index first, [[maybe_unused]] Eigen::Index count, [[maybe_unused]] Scalar lead,
                [[maybe_unused]] const Rates& rates) noexcept {
    auto& J = std::get<k>(J_);
    if constexpr (!std::is_same_v<std::decay_t<decltype(J)>, DiagonalLevel<N, Scalar>>) {
      for (Eigen::Index j = 0; j < J.cols(); ++j) {
        for (Eigen::Index i = first; i < first + count; ++i) J.coeffRef(i, j) += lead * rates.Jd.coeff(i, j);
      }
    }
  }

  /// Calls f(k, J_k) for the enabled levels k = 1 … K − 1 below the first level.
  template <typename F>
  void each_lower(F&& f) const noexcept {
    each_from(f, std::make_index_sequence<sizeof...(Matrices) - 1>{});
  }

 private:
  template <typename F, std::size_t... k>
  void each_from(F& f, std::index_sequence<k...>) const noexcept {
    ((enabled_[k + 1] && std::get<k + 1>(J_).rows() > 0 ? f(k + 1, std::get<k + 1>(J_)) : void()), ...);
  }

  std::array<bool, sizeof...(Matrices)> enabled_;
  const Vector<N, Scalar>* first_motion_ = nullptr;
  std::tuple<Matrices...> J_;
};

/// Joint motion that resolves task levels within a box.
template <int N, typename Scalar, int K>
struct SaturatedLevels : SaturatedMotion<N, Scalar> {
  std::array<Scalar, K> scales;  ///< Task scale s_k of each level. scales[0] is scale.
};

template <int N, typename Scalar, typename... Matrices>
[[nodiscard]] const auto& first_level(const TaskLevels<N, Scalar, Matrices...>& levels) noexcept {
  return levels.first();
}

template <int N, typename Scalar, typename... Matrices>
inline constexpr bool kHasLower<TaskLevels<N, Scalar, Matrices...>> = sizeof...(Matrices) > 1;

template <int N, typename Scalar, typename... Matrices>
[[nodiscard]] const Vector<N, Scalar>& first_motion(const TaskLevels<N, Scalar, Matrices...>& levels,
                                                    const Vector<N, Scalar>& desired) noexcept {
  return levels.first_motion(desired);
}

/// The first level alone.
template <int N, typename Scalar, typename... Matrices>
[[nodiscard]] auto only_first(TaskLevels<N, Scalar, Matrices...> levels) noexcept {
  levels.disable_lower();
  return levels;
}
template <int N, typename Scalar, int K>
void set_scale(SaturatedLevels<N, Scalar, K>& motion, Scalar scale) noexcept {
  motion.scale = scale;
  motion.scales.fill(scale);
}

template <int N, typename Scalar, typename... Matrices>
[[nodiscard]] auto with_scale(const TaskLevels<N, Scalar, Matrices...>&, const Vector<N, Scalar>& u,
                              Scalar scale) noexcept {
  SaturatedLevels<N, Scalar, static_cast<int>(sizeof...(Matrices))> result{{u, scale, 0, 0}, {}};
  set_scale(result, scale);
  return result;
}

template <int N, typename Scalar, int K>
void multiply_scales(SaturatedLevels<N, Scalar, K>& motion, const SaturatedLevels<N, Scalar, K>& other) noexcept {
  for (std::size_t k = 0; k < motion.scales.size(); ++k) motion.scales[k] *= other.scales[k];
  motion.scale = motion.scales[0];
}

template <int N, typename Scalar, typename... Matrices, typename First, typename Lower>
void multiply_scales(SaturatedLevels<N, Scalar, static_cast<int>(sizeof...(Matrices))>& motion,
                     const TaskLevels<N, Scalar, Matrices...>& levels, const First& first,
                     const Lower& lower) noexcept {
  motion.scales[0] *= first(levels.first());
  levels.each_lower([&](std::size_t k, const auto& J) noexcept { motion.scales[k] *= lower(J); });
  motion.scale = motion.scales[0];
}

}  // namespace fpbm
