#pragma once

#include <array>
#include <cstddef>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/entrywise.hpp"
#include "fpbm/linalg/pair.hpp"
#include "fpbm/linalg/split_vector.hpp"

namespace fpbm {

/// The axes of a chain's joints, from which J and Jd follow.
///
/// Column i of J is [zᵢ × (p − pᵢ); zᵢ] for a joint that turns about the axis zᵢ through pᵢ, with the tip at p, and
/// [zᵢ; 0] for one that slides along it. Where it is [lᵢ; aᵢ], that of Jd is [wᵢ × lᵢ + aᵢ × uᵢ; wᵢ × aᵢ], with
/// wᵢ = Σ_{j≤i} q̇ⱼ aⱼ and uᵢ = Σ_{j>i} q̇ⱼ lⱼ: docs/equations.md proves it. Joints are taken two by two.
template <int N, typename Scalar>
class Screws {
 public:
  /// A joint's axis, a point of it, and the angular velocity of what the joint moves.
  struct Joint {
    SplitVector<Scalar> axis;
    SplitVector<Scalar> point;
    SplitVector<Scalar> w;
  };

  /// Joints i and i + 1; where there is no second, anything finite. i is even.
  void set(Eigen::Index i, const Joint& a, const Joint& b) noexcept {
    joints_[static_cast<std::size_t>(i / 2)] = {both(a.axis, b.axis), both(a.point, b.point), both(a.w, b.w)};
  }

  void set_tip(const SplitVector<Scalar>& p) noexcept {
    tip_ = both(p, p);
    u_ = both({}, {});
  }

  /// Columns i and i + 1 of J, and of Jd along qd; those of joints nearer the tip come before. turns is 1 for a joint
  /// that turns and 0 for one that slides.
  template <bool kWithRate, bool kSlides, int M>
  [[gnu::always_inline]] void columns(Eigen::Index i, [[maybe_unused]] const Vector<N, Scalar>& turns,
                                      [[maybe_unused]] const Vector<N, Scalar>& qd, Matrix<M, N, Scalar>& J,
                                      [[maybe_unused]] Matrix<M, N, Scalar>& Jd) noexcept {
    const Joints& joints = joints_[static_cast<std::size_t>(i / 2)];
    const Two3 &axis = joints.axis, &point = joints.point, &w = joints.w;
    const Two3 lever = entrywise(tip_, [&](Eigen::Index k) { return tip_.coeff(k) - point.coeff(k); });
    Columns columns{cross<Two>(axis, lever), axis};
    if constexpr (kSlides) {
      const Two turn = two_of(turns, i);
      const Two slide = Two(Scalar(1)) - turn;
      const Two3 turned = columns.linear;
      columns = {entrywise(axis, [&](Eigen::Index k) { return turn * turned.coeff(k) + slide * axis.coeff(k); }),
                 entrywise(axis, [&](Eigen::Index k) { return turn * axis.coeff(k); })};
    }
    columns.store(J, i);
    if constexpr (kWithRate) {
      const Two3 &l = columns.linear, &a = columns.angular;
      const Two rate = two_of(qd, i);
      const Two3 moved = entrywise(l, [&](Eigen::Index k) { return rate * l.coeff(k); });
      for (int row = 0; row < 3; ++row) u_(row) += Two(moved(row).second(), Scalar(0));
      const Two3 turning = cross<Two>(w, l);
      const Two3 carried = cross<Two>(a, u_);
      Columns{entrywise(turning, [&](Eigen::Index k) { return turning.coeff(k) + carried.coeff(k); }), cross<Two>(w, a)}
          .store(Jd, i);
      for (int row = 0; row < 3; ++row) u_(row) = Two(u_(row).first() + moved(row).first());
    }
  }

 private:
  using Two = Pair<Scalar>;
  using Two3 = Vector<3, Two>;  ///< Vectors of two joints, side by side.

  struct Joints {
    Two3 axis;
    Two3 point;
    Two3 w;
  };

  struct Columns {
    Two3 linear;
    Two3 angular;

    /// As columns i and, where there is one, i + 1 of a matrix of six rows, or of the three linear ones.
    template <int M>
    [[gnu::always_inline]] void store(Matrix<M, N, Scalar>& to, Eigen::Index i) const noexcept {
      if (i + 1 < to.cols()) {
        store_one<M>(seconds<Scalar>(linear(0), linear(1)), seconds<Scalar>(linear(2), angular(0)),
                     seconds<Scalar>(angular(1), angular(2)), &to.coeffRef(0, i + 1));
      }
      store_one<M>(firsts<Scalar>(linear(0), linear(1)), firsts<Scalar>(linear(2), angular(0)),
                   firsts<Scalar>(angular(1), angular(2)), &to.coeffRef(0, i));
    }

    template <int M>
    static void store_one(const Two& a, const Two& b, [[maybe_unused]] const Two& c, Scalar* to) noexcept {
      a.store(to);
      if constexpr (M == 6) {
        b.store(to + 2);
        c.store(to + 4);
      } else {
        to[2] = b.first();
      }
    }
  };

  [[nodiscard]] static Two3 both(const SplitVector<Scalar>& a, const SplitVector<Scalar>& b) noexcept {
    return {firsts(a.xy, b.xy), seconds(a.xy, b.xy), Two(a.z, b.z)};
  }

  Two3 tip_;
  Two3 u_;  ///< Of the pair at hand, then of the joint before it, twice.
  std::array<Joints, (kCapacity<N> + 1) / 2> joints_;
};

}  // namespace fpbm
