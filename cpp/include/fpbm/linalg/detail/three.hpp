#pragma once

#include "fpbm/linalg/detail/pair.hpp"

namespace fpbm {

/// Vector in space as three separate entries, which may be pairs. A compiler keeps the entries in registers, but stores
/// a matrix in memory.
template <typename Value>
struct Three {
  Value x;
  Value y;
  Value z;

  friend Three operator+(const Three& a, const Three& b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Three operator-(const Three& a, const Three& b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Three operator*(const Value& s, const Three& a) noexcept { return {s * a.x, s * a.y, s * a.z}; }
};

template <typename Value>
[[nodiscard]] Value dot(const Three<Value>& a, const Three<Value>& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename Value>
[[nodiscard, gnu::always_inline]] inline Three<Value> cross(const Three<Value>& a, const Three<Value>& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Vector of three adjacent numbers.
template <typename Value>
[[nodiscard]] Three<Value> three(const Value* from) noexcept {
  return {from[0], from[1], from[2]};
}

/// Two vectors as one vector of pairs.
template <typename Scalar>
[[nodiscard]] Three<Pair<Scalar>> three(const Scalar* first, const Scalar* second) noexcept {
  return {{first[0], second[0]}, {first[1], second[1]}, {first[2], second[2]}};
}

/// a with every entry repeated in all entries of a Value.
template <typename Value, typename Scalar>
[[nodiscard]] Three<Value> repeated(const Three<Scalar>& a) noexcept {
  return {Value(a.x), Value(a.y), Value(a.z)};
}

template <typename Scalar>
[[nodiscard]] Three<Scalar> first(const Three<Pair<Scalar>>& a) noexcept {
  return {a.x.first(), a.y.first(), a.z.first()};
}
template <typename Scalar>
[[nodiscard]] Three<Scalar> second(const Three<Pair<Scalar>>& a) noexcept {
  return {a.x.second(), a.y.second(), a.z.second()};
}

/// The first entries of a and b, and the second entries of a and b.
template <typename Scalar>
[[nodiscard]] Three<Pair<Scalar>> firsts(const Three<Pair<Scalar>>& a, const Three<Pair<Scalar>>& b) noexcept {
  return {firsts(a.x, b.x), firsts(a.y, b.y), firsts(a.z, b.z)};
}
template <typename Scalar>
[[nodiscard]] Three<Pair<Scalar>> seconds(const Three<Pair<Scalar>>& a, const Three<Pair<Scalar>>& b) noexcept {
  return {seconds(a.x, b.x), seconds(a.y, b.y), seconds(a.z, b.z)};
}

template <typename Scalar>
[[nodiscard]] Pair<Scalar> swapped(const Pair<Scalar>& a) noexcept {
  return {a.second(), a.first()};
}
template <typename Scalar>
[[nodiscard]] Three<Pair<Scalar>> swapped(const Three<Pair<Scalar>>& a) noexcept {
  return {swapped(a.x), swapped(a.y), swapped(a.z)};
}

template <typename Scalar>
[[nodiscard]] Scalar sum(const Pair<Scalar>& a) noexcept {
  return a.first() + a.second();
}

}  // namespace fpbm
