#pragma once

#include <Eigen/Core>
#include <limits>
#include <type_traits>
#include <utility>

/// A mask is the result of a comparison: a bool, or one bool for each lane. A mask of lanes cannot be the condition of
/// an `if`.
///
/// Code for any Scalar therefore uses all_of(mask), or where(mask, x) = y as in std::experimental::simd.
namespace fpbm {

template <typename Scalar>
using Mask = decltype(std::declval<const Scalar&>() > std::declval<const Scalar&>());

/// Whether a Scalar holds several numbers, one per lane. If a lane fails, the computation continues in the other lanes.
template <typename Scalar>
inline constexpr bool kInLanes = !std::is_same_v<Mask<Scalar>, bool>;

/// Type of one lane of a Scalar, or Scalar itself if it is a single number.
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

[[nodiscard]] inline bool any_of(bool truth) noexcept {
  return truth;
}

/// yes where the mask is true, else no.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline Scalar select(const Mask<Scalar>& mask, const Scalar& yes,
                                                       const Scalar& no) noexcept {
  if constexpr (kInLanes<Scalar>) {
    Scalar result = no;
    where(mask, result) = yes;
    return result;
  } else {
    return mask ? yes : no;
  }
}

/// Sets the lanes of value whose mask is false to NaN. Has no effect on a single number: a Status reports the failure.
template <typename Masks, typename Scalar>
void set_nan_unless([[maybe_unused]] const Masks& truth, [[maybe_unused]] Scalar& value) noexcept {
  if constexpr (kInLanes<Scalar>) {
    where(!truth, value) = Scalar(std::numeric_limits<Number<Scalar>>::quiet_NaN());
  }
}

}  // namespace fpbm
