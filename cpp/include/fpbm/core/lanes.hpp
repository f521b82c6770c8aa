#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

#include "fpbm/core/types.hpp"

namespace fpbm {

template <typename Scalar, int K>
struct LanesRegister {
#if defined(__GNUC__)  // And all who say they are.
  using type [[gnu::vector_size(K * sizeof(Scalar))]] = Scalar;
#else
  using type = Eigen::Array<Scalar, K, 1, Eigen::DontAlign>;
#endif
};

/// K numbers side by side, calculated with as one: vector code on every processor that has it.
///
/// Small algorithms written for a Value do K problems at once with Value = Lanes<Scalar, K>; comparisons hold where
/// they hold in all lanes.
template <typename Scalar, int K>
struct Lanes {
  using Register = typename LanesRegister<Scalar, K>::type;
  Register lanes;

  [[nodiscard]] Scalar operator[](int lane) const noexcept { return lanes[lane]; }

  friend Lanes operator+(const Lanes& a, const Lanes& b) noexcept { return {a.lanes + b.lanes}; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) noexcept { return {a.lanes - b.lanes}; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) noexcept { return {a.lanes * b.lanes}; }
  friend Lanes operator*(Scalar a, const Lanes& b) noexcept { return {a * b.lanes}; }
  friend Lanes operator/(Scalar a, const Lanes& b) noexcept { return {a / b.lanes}; }
  Lanes& operator+=(const Lanes& b) noexcept { return *this = *this + b; }
  Lanes& operator-=(const Lanes& b) noexcept { return *this = *this - b; }
  Lanes& operator*=(const Lanes& b) noexcept { return *this = *this * b; }

  friend bool operator>(const Lanes& a, const Lanes& b) noexcept {
    bool all = true;
    for (int i = 0; i < K; ++i) all = all && a[i] > b[i];
    return all;
  }
};

/// a in the first lane, b in the second.
template <typename Scalar>
[[nodiscard]] Lanes<Scalar, 2> side_by_side(Scalar a, Scalar b) noexcept {
  return {typename Lanes<Scalar, 2>::Register{a, b}};
}

/// The numbers that a Value is made of.
template <typename Value>
struct ScalarOf {
  using type = Value;
};
template <typename Scalar, int K>
struct ScalarOf<Lanes<Scalar, K>> {
  using type = Scalar;
};

/// The same number in every lane.
template <typename Value>
[[nodiscard]] Value splat(typename ScalarOf<Value>::type a) noexcept {
  if constexpr (std::is_same_v<Value, typename ScalarOf<Value>::type>) {
    return a;
  } else {
    return {a - typename Value::Register{}};  // Not +, since −0 + 0 is another number.
  }
}

/// What is in the first lane.
template <typename Scalar>
[[nodiscard]] Scalar first(Scalar a) noexcept {
  return a;
}
template <typename Scalar, int K>
[[nodiscard]] Scalar first(const Lanes<Scalar, K>& a) noexcept {
  return a[0];
}

template <typename Scalar>
[[nodiscard]] Scalar larger(Scalar a, Scalar b) noexcept {
  return a > b ? a : b;
}
template <typename Scalar, int K>
[[nodiscard]] Lanes<Scalar, K> larger(Lanes<Scalar, K> a, const Lanes<Scalar, K>& b) noexcept {
  for (int i = 0; i < K; ++i) a.lanes[i] = larger(a[i], b[i]);
  return a;
}

template <typename Scalar>
[[nodiscard]] bool is_finite(Scalar a) noexcept {
  return std::isfinite(a);
}
template <typename Scalar, int K>
[[nodiscard]] bool is_finite(const Lanes<Scalar, K>& a) noexcept {
  bool all = true;
  for (int i = 0; i < K; ++i) all = all && std::isfinite(a[i]);
  return all;
}

/// Entry by entry, a in the first lane, b in the second.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Lanes<Scalar, 2>> side_by_side(const Matrix<Rows, Cols, Scalar>& a,
                                                                const Matrix<Rows, Cols, Scalar>& b) noexcept {
  Matrix<Rows, Cols, Lanes<Scalar, 2>> result;
  result.resize(a.rows(), a.cols());
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) result(i, j) = side_by_side(a(i, j), b(i, j));
  }
  return result;
}

/// One lane of every entry.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Scalar> lane(const Matrix<Rows, Cols, Lanes<Scalar, 2>>& a, int which) noexcept {
  Matrix<Rows, Cols, Scalar> result;
  result.resize(a.rows(), a.cols());
  for (Eigen::Index i = 0; i < a.size(); ++i) result(i) = a(i)[which];
  return result;
}

}  // namespace fpbm

/// So that matrices may hold lanes.
template <typename Scalar, int K>
struct Eigen::NumTraits<fpbm::Lanes<Scalar, K>> : Eigen::GenericNumTraits<fpbm::Lanes<Scalar, K>> {
  enum { RequireInitialization = 0 };
};
