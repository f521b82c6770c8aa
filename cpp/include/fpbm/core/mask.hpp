#pragma once

#include <Eigen/Core>
#include <limits>
#include <type_traits>
#include <utility>

/// What comparing two Scalars comes to: a bool or, where a Scalar is many numbers side by side, a mask with a truth for
/// each, which no branch takes. Code for any Scalar says all_of(truth), or leaves the choice to where(truth, x) = y, as
/// std::experimental::simd does.
namespace fpbm {

template <typename Scalar>
using Mask = decltype(std::declval<const Scalar&>() > std::declval<const Scalar&>());

/// Whether a Scalar is many numbers, of which some may fail and the others go on.
template <typename Scalar>
inline constexpr bool kInLanes = !std::is_same_v<Mask<Scalar>, bool>;

/// One of the numbers that a Scalar is.
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

/// What fails in some lanes becomes NaN there, and stays it; a single number's failure is its Status.
template <typename Masks, typename Scalar>
void set_nan_unless([[maybe_unused]] const Masks& truth, [[maybe_unused]] Scalar& value) noexcept {
  if constexpr (kInLanes<Scalar>) {
    where(!truth, value) = Scalar(std::numeric_limits<Number<Scalar>>::quiet_NaN());
  }
}

/// Whether all entries are finite. In lanes they need not be: what is not, the others do not see.
template <typename Derived>
[[nodiscard]] bool is_finite([[maybe_unused]] const Eigen::MatrixBase<Derived>& values) noexcept {
  if constexpr (kInLanes<typename Derived::Scalar>) {
    return true;
  } else {
    return values.allFinite();
  }
}

}  // namespace fpbm
