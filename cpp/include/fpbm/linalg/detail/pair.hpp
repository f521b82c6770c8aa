#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/pair_storage.hpp"

namespace fpbm {

/// Two Scalars with entrywise arithmetic. With Value = Pair<Scalar>, a small algorithm for a Value solves two problems
/// in parallel. A comparison is true if it is true for both entries.
template <typename Scalar>
class Pair {
 public:
  Pair() = default;
  Pair(const Scalar& a, const Scalar& b) noexcept : both_{a, b} {}
  explicit Pair(const Scalar& a) noexcept : both_{a, a} {}

  /// Loads two adjacent entries in one operation.
  [[nodiscard]] static Pair load(const Scalar* from) noexcept {
    if constexpr (kIsVector) {
      Pair result;
      std::memcpy(&result.both_, from, sizeof result.both_);
      return result;
    } else {
      return {from[0], from[1]};
    }
  }
  /// Stores two adjacent entries in one operation. After two separate stores, a later load of both entries would stall
  /// the processor.
  void store(Scalar* to) const noexcept {
    if constexpr (kIsVector) {
      std::memcpy(to, &both_, sizeof both_);
    } else {
      to[0] = first();
      to[1] = second();
    }
  }

  [[nodiscard]] Scalar first() const noexcept { return both_[0]; }
  [[nodiscard]] Scalar second() const noexcept { return both_[1]; }

  friend Pair operator+(const Pair& x, const Pair& y) noexcept { return Pair(x.both_ + y.both_, kAll); }
  friend Pair operator-(const Pair& x, const Pair& y) noexcept { return Pair(x.both_ - y.both_, kAll); }
  friend Pair operator*(const Pair& x, const Pair& y) noexcept { return Pair(x.both_ * y.both_, kAll); }
  friend Pair operator/(const Pair& x, const Pair& y) noexcept { return Pair(x.both_ / y.both_, kAll); }
  Pair& operator+=(const Pair& y) noexcept { return *this = *this + y; }
  Pair& operator-=(const Pair& y) noexcept { return *this = *this - y; }
  Pair& operator*=(const Pair& y) noexcept { return *this = *this * y; }

  friend Mask<Scalar> operator>(const Pair& x, const Pair& y) noexcept {
    return x.first() > y.first() && x.second() > y.second();
  }
  friend Pair max(const Pair& x, const Pair& y) noexcept {
    using std::max;
    return {max(x.first(), y.first()), max(x.second(), y.second())};
  }
  friend bool is_finite(const Pair& x) noexcept { return std::isfinite(x.first()) && std::isfinite(x.second()); }

 private:
  using Both = typename PairStorage<Scalar>::type;
  static constexpr bool kIsVector = !std::is_same_v<Both, PlainPair<Scalar>>;
  struct All {};
  static constexpr All kAll{};

  Pair(const Both& both, All) noexcept : both_(both) {}

  Both both_;
};

/// Scalar if Value is Pair<Scalar>, else Value.
template <typename Value>
struct ScalarOf {
  using type = Value;
};
template <typename Scalar>
struct ScalarOf<Pair<Scalar>> {
  using type = Scalar;
};

template <typename Scalar>
[[nodiscard]] Scalar first(const Scalar& a) noexcept {
  return a;
}
template <typename Scalar>
[[nodiscard]] Scalar first(const Pair<Scalar>& a) noexcept {
  return a.first();
}

/// The first entries of a and b, and the second entries of a and b.
template <typename Scalar>
[[nodiscard]] Pair<Scalar> firsts(const Pair<Scalar>& a, const Pair<Scalar>& b) noexcept {
  return {a.first(), b.first()};
}
template <typename Scalar>
[[nodiscard]] Pair<Scalar> seconds(const Pair<Scalar>& a, const Pair<Scalar>& b) noexcept {
  return {a.second(), b.second()};
}

/// Entries i and i + 1 of a vector. The second is zero if entry i + 1 does not exist.
template <int N, typename Scalar>
[[nodiscard]] Pair<Scalar> two_of(const Vector<N, Scalar>& vector, Eigen::Index i) noexcept {
  return i + 1 < vector.size() ? Pair<Scalar>::load(vector.data() + i) : Pair<Scalar>(vector.coeff(i), Scalar(0));
}
/// Sets entries i and i + 1. If entry i + 1 does not exist, sets entry i.
template <int N, typename Scalar>
void set_two_of(Vector<N, Scalar>& vector, Eigen::Index i, const Pair<Scalar>& two) noexcept {
  if (i + 1 < vector.size()) {
    two.store(vector.data() + i);
  } else {
    vector.coeffRef(i) = two.first();
  }
}

template <typename Scalar>
[[nodiscard]] std::enable_if_t<std::is_arithmetic_v<Scalar>, bool> is_finite(Scalar a) noexcept {
  return std::isfinite(a);
}

/// Sets both entries of a lane to NaN if the mask of the lane is false.
template <typename Masks, typename Scalar>
void set_nan_unless(const Masks& truth, Pair<Scalar>& value) noexcept {
  Scalar a = value.first();
  Scalar b = value.second();
  set_nan_unless(truth, a);
  set_nan_unless(truth, b);
  value = {a, b};
}

/// Matrix of the pairs (a(i, j), b(i, j)).
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Pair<Scalar>> side_by_side(const Matrix<Rows, Cols, Scalar>& a,
                                                            const Matrix<Rows, Cols, Scalar>& b) noexcept {
  Matrix<Rows, Cols, Pair<Scalar>> result;
  result.resize(a.rows(), a.cols());
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) result(i, j) = {a(i, j), b(i, j)};
  }
  return result;
}
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Scalar> first(const Matrix<Rows, Cols, Pair<Scalar>>& a) noexcept {
  return entrywise_as<Scalar>(a, [&](Eigen::Index i) { return a.coeff(i).first(); });
}
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Scalar> second(const Matrix<Rows, Cols, Pair<Scalar>>& a) noexcept {
  return entrywise_as<Scalar>(a, [&](Eigen::Index i) { return a.coeff(i).second(); });
}

/// a plus the first entry of each pair. The sums are stored in pairs, since a later load of two entries would stall
/// after separate stores.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> plus_first(Vector<N, Scalar> a, const Vector<N, Pair<Scalar>>& pairs) noexcept {
  const Eigen::Index n = a.size();
  for (Eigen::Index i = 0; i < n; i += 2) {
    set_two_of(a, i, two_of(a, i) + (i + 1 < n ? firsts(pairs.coeff(i), pairs.coeff(i + 1)) : pairs.coeff(i)));
  }
  return a;
}

}  // namespace fpbm

/// Allows Eigen matrices of pairs.
template <typename Scalar>
struct Eigen::NumTraits<fpbm::Pair<Scalar>> : Eigen::GenericNumTraits<fpbm::Pair<Scalar>> {
  enum { RequireInitialization = 0 };  // NOLINT(readability-identifier-naming): Eigen's name.
};
