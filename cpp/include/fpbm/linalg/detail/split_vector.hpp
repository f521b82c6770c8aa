#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/pair.hpp"

namespace fpbm {

/// Vector in space, with x and y in a Pair.
template <typename Scalar>
struct SplitVector {
  Pair<Scalar> xy{Scalar(0)};
  Scalar z{0};

  SplitVector() = default;
  SplitVector(const Pair<Scalar>& first_two, const Scalar& third) noexcept : xy(first_two), z(third) {}

  /// Loads three adjacent entries.
  [[nodiscard]] static SplitVector load(const Scalar* from) noexcept { return {Pair<Scalar>::load(from), from[2]}; }
  void store(Scalar* to) const noexcept {
    xy.store(to);
    to[2] = z;
  }

  friend SplitVector operator+(const SplitVector& a, const SplitVector& b) noexcept { return {a.xy + b.xy, a.z + b.z}; }
  friend SplitVector operator-(const SplitVector& a, const SplitVector& b) noexcept { return {a.xy - b.xy, a.z - b.z}; }
  /// Product with a number s, which is in both entries of the pair.
  friend SplitVector operator*(const Pair<Scalar>& s, const SplitVector& a) noexcept {
    return {s * a.xy, s.first() * a.z};
  }
  SplitVector& operator+=(const SplitVector& a) noexcept { return *this = *this + a; }
};

}  // namespace fpbm
