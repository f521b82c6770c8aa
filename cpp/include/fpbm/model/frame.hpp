#pragma once

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/pair.hpp"
#include "fpbm/linalg/split_vector.hpp"

namespace fpbm {

/// A number kept twice, so that it is read as a pair at once.
template <typename Scalar>
struct Twice {
  Scalar both[2];

  Twice() = default;
  explicit Twice(const Scalar& a) noexcept : both{a, a} {}

  [[nodiscard]] Pair<Scalar> operator()() const noexcept { return Pair<Scalar>::load(both); }
  template <typename Other>
  [[nodiscard]] Twice<Other> cast() const noexcept {
    return Twice<Other>(static_cast<Other>(both[0]));
  }
};

/// Cosine and sine of a constant angle.
template <typename Scalar>
struct Turn {
  Twice<Scalar> cosine;
  Twice<Scalar> sine;

  template <typename Other>
  [[nodiscard]] Turn<Other> cast() const noexcept {
    return {cosine.template cast<Other>(), sine.template cast<Other>()};
  }
};

/// The frame that is carried along a chain, in base axes.
template <typename Scalar>
struct Frame {
  SplitVector<Scalar> p;
  SplitVector<Scalar> x;
  SplitVector<Scalar> y;
  SplitVector<Scalar> z;

  explicit Frame(const Transform<Scalar>& at) noexcept
      : p(SplitVector<Scalar>::load(at.p.data())),
        x(SplitVector<Scalar>::load(at.R.data())),
        y(SplitVector<Scalar>::load(at.R.data() + 3)),
        z(SplitVector<Scalar>::load(at.R.data() + 6)) {}

  /// About its z axis.
  void turn(const Pair<Scalar>& cosine, const Pair<Scalar>& sine) noexcept { rotate(x, y, cosine, sine); }
  /// About its x axis.
  void store(Transform<Scalar>& to) const noexcept {
    p.store(to.p.data());
    x.store(to.R.data());
    y.store(to.R.data() + 3);
    z.store(to.R.data() + 6);
  }
  void tilt(const Pair<Scalar>& cosine, const Pair<Scalar>& sine) noexcept { rotate(y, z, cosine, sine); }

 private:
  static void rotate(SplitVector<Scalar>& a, SplitVector<Scalar>& b, const Pair<Scalar>& cosine,
                     const Pair<Scalar>& sine) noexcept {
    const SplitVector<Scalar> from = a;
    a = cosine * from + sine * b;
    b = cosine * b - sine * from;
  }
};

}  // namespace fpbm
