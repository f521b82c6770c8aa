#pragma once

#include <array>
#include <cstddef>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/split_vector.hpp"

namespace fpbm {

/// Axes of the joints of a chain, from which J and Jd are computed.
///
/// Column i of J is [zᵢ × (p − pᵢ); zᵢ] for a revolute joint with the axis zᵢ through pᵢ and the tip at p, and [zᵢ; 0]
/// for a prismatic joint along zᵢ. If this column is [lᵢ; aᵢ], column i of Jd is [wᵢ × lᵢ + aᵢ × uᵢ; wᵢ × aᵢ], with wᵢ
/// = Σ_{j≤i} q̇ⱼ aⱼ and uᵢ = Σ_{j>i} q̇ⱼ lⱼ (docs/kinematics.md, Time derivative of J). Joints are computed in pairs.
template <int N, typename Scalar>
class Screws {
 public:
  using Two = Pair<Scalar>;
  using Two3 = Vector<3, Two>;  ///< Vectors of two joints, as a vector of pairs.

  /// Axis of a joint, a point of the axis, and the angular velocity of the link that the joint moves.
  struct Joint {
    SplitVector<Scalar> axis;
    SplitVector<Scalar> point;
    SplitVector<Scalar> w;
  };

  /// Sets joints i and i + 1, where i is even. A joint that does not exist is Joint{}.
  void set(Eigen::Index i, const Joint& a, const Joint& b) noexcept {
    joints_[static_cast<std::size_t>(i / 2)] = {both(a.axis, b.axis), both(a.point, b.point), both(a.w, b.w)};
  }

  /// Columns of J or Jd for two joints.
  struct ColumnPair {
    Two3 linear;
    Two3 angular;

    [[nodiscard]] static ColumnPair zero() noexcept { return {both({}, {}), both({}, {})}; }
    friend ColumnPair operator-(const ColumnPair& a, const ColumnPair& b) noexcept {
      return {entrywise(a.linear, [&](Eigen::Index k) { return a.linear.coeff(k) - b.linear.coeff(k); }),
              entrywise(a.linear, [&](Eigen::Index k) { return a.angular.coeff(k) - b.angular.coeff(k); })};
    }

    /// Stores column i, and column i + 1 if it exists, of a matrix of six rows, or of three linear rows.
    template <typename To>
    [[gnu::always_inline]] void store(To& to, Eigen::Index i) const noexcept {
      constexpr int M = To::RowsAtCompileTime;
      if (i + 1 < to.cols()) {
        store_one<M>(seconds<Scalar>(linear(0), linear(1)), seconds<Scalar>(linear(2), angular(0)),
                     seconds<Scalar>(angular(1), angular(2)), &to.coeffRef(0, i + 1));
      }
      store_one<M>(firsts<Scalar>(linear(0), linear(1)), firsts<Scalar>(linear(2), angular(0)),
                   firsts<Scalar>(angular(1), angular(2)), &to.coeffRef(0, i));
    }

    /// Loads columns i and i + 1 of a matrix of six rows. A column that does not exist is zero.
    template <typename From>
    [[nodiscard]] static ColumnPair load(const From& from, Eigen::Index i) noexcept {
      const auto two = [&](Eigen::Index row) {
        return Two(from.coeff(row, i), i + 1 < from.cols() ? from.coeff(row, i + 1) : Scalar(0));
      };
      return {{two(0), two(1), two(2)}, {two(3), two(4), two(5)}};
    }

   private:
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

  /// Point that the joints move [m], and uᵢ of the current pair of joints [m/s].
  class Point {
   public:
    explicit Point(const SplitVector<Scalar>& p) noexcept : p_(both(p, p)), u_(both({}, {})) {}

    /// Velocity of the point [m/s]. Call this function after rates() was called for all joints that move the point.
    [[nodiscard]] Vector<3, Scalar> velocity() const noexcept {
      return entrywise_as<Scalar>(u_, [&](Eigen::Index k) { return u_.coeff(k).first(); });
    }

   private:
    friend class Screws;

    Two3 p_;
    Two3 u_;  ///< uᵢ of a pair of joints; after rates(), the value for the joint before the pair, in both entries.
  };

  /// Two joints as vectors of pairs.
  struct JointPair {
    Two3 axis;
    Two3 point;
    Two3 w;

    /// Copy of the pair, with zero axes for joints whose bits are not set.
    [[nodiscard]] JointPair only(JointBits bits) const noexcept {
      const Two mask(Scalar(bits & 1U), Scalar(bits >> 1 & 1U));
      return {entrywise(axis, [&](Eigen::Index k) { return mask * axis.coeff(k); }), point, w};
    }
  };
  /// Joints i and i + 1.
  [[nodiscard]] const JointPair& joints(Eigen::Index i) const noexcept {
    return joints_[static_cast<std::size_t>(i / 2)];
  }

  /// Columns i and i + 1 of J. turns: 1 for a revolute joint, 0 for a prismatic joint. slides: whether the chain has a
  /// prismatic joint.
  [[nodiscard, gnu::always_inline]] static ColumnPair columns(Eigen::Index i, const JointPair& joints,
                                                              const Point& point, const Vector<N, Scalar>& turns,
                                                              bool slides) noexcept {
    const Two3& axis = joints.axis;
    const Two3 lever = entrywise(axis, [&](Eigen::Index k) { return point.p_.coeff(k) - joints.point.coeff(k); });
    const Two3 turned = cross<Two>(axis, lever);
    if (!slides) return {turned, axis};
    const Two turn = two_of(turns, i);
    const Two slide = Two(Scalar(1)) - turn;
    return {entrywise(axis, [&](Eigen::Index k) { return turn * turned.coeff(k) + slide * axis.coeff(k); }),
            entrywise(axis, [&](Eigen::Index k) { return turn * axis.coeff(k); })};
  }

  /// Columns i and i + 1 of Jd along qd. Call once for each pair of joints that move the point, in the order from the
  /// point to the base.
  [[nodiscard, gnu::always_inline]] static ColumnPair rates(Eigen::Index i, const JointPair& joints,
                                                            const ColumnPair& columns, Point& point,
                                                            const Vector<N, Scalar>& qd) noexcept {
    const Two3& w = joints.w;
    const Two3 &l = columns.linear, &a = columns.angular;
    const Two rate = two_of(qd, i);
    const Two3 moved = entrywise(l, [&](Eigen::Index k) { return rate * l.coeff(k); });
    for (int row = 0; row < 3; ++row) point.u_(row) += Two(moved(row).second(), Scalar(0));
    const Two3 turning = cross<Two>(w, l);
    const Two3 carried = cross<Two>(a, point.u_);
    for (int row = 0; row < 3; ++row) point.u_(row) = Two(point.u_(row).first() + moved(row).first());
    return {entrywise(turning, [&](Eigen::Index k) { return turning.coeff(k) + carried.coeff(k); }), cross<Two>(w, a)};
  }

  /// Angular rows of columns(), and of rates().
  [[nodiscard, gnu::always_inline]] static Two3 angular_columns(Eigen::Index i, const JointPair& joints,
                                                                const Vector<N, Scalar>& turns, bool slides) noexcept {
    const Two turn = slides ? two_of(turns, i) : Two(Scalar(1));
    return entrywise(joints.axis, [&](Eigen::Index k) { return turn * joints.axis.coeff(k); });
  }
  [[nodiscard, gnu::always_inline]] static Two3 angular_rates(const JointPair& joints, const Two3& columns) noexcept {
    return cross<Two>(joints.w, columns);
  }

  /// Angular velocity of the link that joint i moves [rad/s].
  [[nodiscard]] Vector<3, Scalar> angular_velocity(Eigen::Index i) const noexcept {
    const Two3& w = joints(i).w;
    return entrywise_as<Scalar>(w,
                                [&](Eigen::Index k) { return i % 2 == 0 ? w.coeff(k).first() : w.coeff(k).second(); });
  }

 private:
  [[nodiscard]] static Two3 both(const SplitVector<Scalar>& a, const SplitVector<Scalar>& b) noexcept {
    return {firsts(a.xy, b.xy), seconds(a.xy, b.xy), Two(a.z, b.z)};
  }
  std::array<JointPair, (kCapacity<N> + 1) / 2> joints_;
};

}  // namespace fpbm
