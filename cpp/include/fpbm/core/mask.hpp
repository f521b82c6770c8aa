#pragma once

#include <Eigen/Core>
#include <limits>
#include <type_traits>
#include <utility>

/// Result of a comparison: bool, or a mask of lanes, which cannot drive an `if`.
///
/// Code for any Scalar uses all_of(mask), or where(mask, x) = y as std::experimental::simd does.
namespace fpbm {

template <typename Scalar>
using Mask = decltype(std::declval<const Scalar&>() > std::declval<const Scalar&>());

/// Whether a Scalar holds several numbers, one a lane. A lane may fail while the others go on.
template <typename Scalar>
inline constexpr bool kInLanes = !std::is_same_v<Mask<Scalar>, bool>;

/// Type of one lane of a Scalar; Scalar itself where it is a single number.
template <typename Scalar, typename = void>
struct NumberOf {
  using type = Scalar;
};
template <typename Scalar>
struct NumberOf<Scalar, std::enable_if_t<kInLanes<Scalar>>> {
  using type = typename Scalar::value_type;
};
template <typename Scalar>
using Number = typename NumberOf<Scalar>::type;

[[nodiscard]] inline bool all_of(bool truth) noexcept {
  return truth;
}

[[nodiscard]] inline bool none_of(bool truth) noexcept {
  return !truth;
}

/// Sets a lane of value to NaN where its mask is false. Does nothing to a single number, whose failure is a Status.
template <typename Masks, typename Scalar>
void set_nan_unless([[maybe_unused]] const Masks& truth, [[maybe_unused]] Scalar& value) noexcept {
  if constexpr (kInLanes<Scalar>) {
    where(!truth, value) = Scalar(std::numeric_limits<Number<Scalar>>::quiet_NaN());
  }
}

}  // namespace fpbm
