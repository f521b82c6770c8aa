#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/split_vector.hpp"
#include "fpbm/model/detail/link.hpp"

namespace fpbm {

/// Constant that is stored twice, so that one load reads both entries of a Pair.
template <typename Scalar>
class Twice {
 public:
  Twice() = default;
  explicit Twice(const Scalar& a) noexcept : both_{a, a} {}

  [[nodiscard]] Pair<Scalar> pair() const noexcept { return Pair<Scalar>::load(both_); }

  template <typename Other>
  [[nodiscard]] Twice<Other> cast() const noexcept {
    return Twice<Other>(Other(both_[0]));
  }

 private:
  Scalar both_[2];
};

/// Cosine and sine of a constant angle.
template <typename Scalar>
struct FixedTurn {
  Twice<Scalar> cosine;
  Twice<Scalar> sine;

  template <typename Other>
  [[nodiscard]] FixedTurn<Other> cast() const noexcept {
    return {cosine.template cast<Other>(), sine.template cast<Other>()};
  }
};

/// Constants of a link for Frame::pass().
template <typename Scalar>
struct LinkPassage {
  Twice<Scalar> step[3];
  FixedTurn<Scalar> tilt;

  LinkPassage() = default;
  explicit LinkPassage(const Link<Scalar>& link)
      : step{Twice<Scalar>(link.step(0)), Twice<Scalar>(link.step(1)), Twice<Scalar>(link.step(2))},
        tilt{Twice<Scalar>(link.cosine), Twice<Scalar>(link.sine)} {}

  template <typename Other>
  [[nodiscard]] LinkPassage<Other> cast() const noexcept {
    LinkPassage<Other> result;
    for (int i = 0; i < 3; ++i) result.step[i] = step[i].template cast<Other>();
    result.tilt = tilt.template cast<Other>();
    return result;
  }
};

/// Frame that moves from joint to joint: origin and axes in the base frame.
template <typename Scalar>
struct Frame {
  using Split = SplitVector<Scalar>;

  Split p;
  Split x;
  Split y;
  Split z;

  explicit Frame(const Transform<Scalar>& at) noexcept
      : p(Split::load(at.p.data())),
        x(Split::load(at.R.data())),
        y(Split::load(at.R.data() + 3)),
        z(Split::load(at.R.data() + 6)) {}

  /// Rotates the frame about z. Both entries of a pair have the same value.
  void turn(const Pair<Scalar>& cosine, const Pair<Scalar>& sine) noexcept { rotate(x, y, cosine, sine); }

  void pass(const LinkPassage<Scalar>& link) noexcept {
    p += link.step[0].pair() * x + link.step[1].pair() * y + link.step[2].pair() * z;
    rotate(y, z, link.tilt.cosine.pair(), link.tilt.sine.pair());
  }

  /// Stores the origin, and the axes as columns.
  void store(Vector<3, Scalar>& origin, Matrix<3, 3, Scalar>& axes) const noexcept {
    p.store(origin.data());
    x.store(axes.data());
    y.store(axes.data() + 3);
    z.store(axes.data() + 6);
  }

 private:
  /// Rotates a and b by an angle in the direction from a to b.
  static void rotate(Split& a, Split& b, const Pair<Scalar>& cosine, const Pair<Scalar>& sine) noexcept {
    const Split from = a;
    a = cosine * from + sine * b;
    b = cosine * b - sine * from;
  }
};

}  // namespace fpbm
