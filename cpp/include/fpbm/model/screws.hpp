#pragma once

#include <array>
#include <cstddef>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/core/unrolled.hpp"
#include "fpbm/linalg/pair.hpp"
#include "fpbm/model/frame.hpp"

namespace fpbm {

/// The axes of a chain's joints, from which J and Jd follow.
///
/// Column i of J is [zᵢ × (p − pᵢ); zᵢ] for a joint that turns about the axis zᵢ through pᵢ, with the tip at p, and
/// [zᵢ; 0] for one that slides along it. For a column [lᵢ; aᵢ] of either kind, that of Jd is
/// [wᵢ × lᵢ + aᵢ × uᵢ; wᵢ × aᵢ] with wᵢ = Σ_{j≤i} q̇ⱼ aⱼ and uᵢ = Σ_{j>i} q̇ⱼ lⱼ (docs/equations.md).
/// Joints are kept, and their columns computed, two by two.
template <int N, typename Scalar>
class Screws {
 public:
  /// A joint's axis, a point on it, and the angular velocity of what it moves.
  struct Joint {
    SplitVector<Scalar> axis;
    SplitVector<Scalar> point;
    SplitVector<Scalar> w;
  };

  /// Joints 2 k and 2 k + 1.
  void set(Eigen::Index k, const Joint& a, const Joint& b) noexcept {
    joints_[static_cast<std::size_t>(k)] = {both(a.axis, b.axis), both(a.point, b.point), both(a.w, b.w)};
  }

  /// Before columns(): with the tip there.
  void start(const SplitVector<Scalar>& tip) noexcept {
    tip_ = both(tip, tip);
    u_ = both({}, {});
  }

  /// Columns i and i + 1 of J, and of Jd along qd unless that is null; those of later joints come first. turns is 1 for
  /// a joint that turns and 0 for one that slides; all turn where it is null.
  template <int M>
  [[gnu::always_inline]] void columns(Eigen::Index i, const Vector<N, Scalar>* turns, const Vector<N, Scalar>* qd,
               Matrix<M, N, Scalar>& J, Matrix<M, N, Scalar>& Jd) noexcept {
    const Joints& joints = joints_[static_cast<std::size_t>(i / 2)];
    Columns columns{cross<Two>(joints.axis, tip_ - joints.point), joints.axis};
    if (turns != nullptr) {
      const Two turn = two_of<N>(*turns, i);
      columns = {turn * columns.linear + (Two(Scalar(1)) - turn) * joints.axis, turn * joints.axis};
    }
    columns.store(J, i);
    if (qd == nullptr) return;
    const Two3 moved = two_of<N>(*qd, i) * columns.linear;
    for (int row = 0; row < 3; ++row) u_(row) += Two(moved(row).second(), Scalar(0));
    Columns{cross<Two>(joints.w, columns.linear) + cross<Two>(columns.angular, u_),
            cross<Two>(joints.w, columns.angular)}
        .store(Jd, i);
    for (int row = 0; row < 3; ++row) u_(row) = Two(u_(row).first() + moved(row).first());
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
      const auto store_one = [this](Scalar* column, const auto& of, const auto& one) {
        of(linear(0), linear(1)).store(column);
        if constexpr (M == 6) {
          of(linear(2), angular(0)).store(column + 2);
          of(angular(1), angular(2)).store(column + 4);
        } else {
          column[2] = one(linear(2));
        }
      };
      if (i + 1 < to.cols()) {
        store_one(&to.coeffRef(0, i + 1), [](const Two& a, const Two& b) { return seconds(a, b); },
                  [](const Two& a) { return a.second(); });
      }
      store_one(&to.coeffRef(0, i), [](const Two& a, const Two& b) { return firsts(a, b); },
                [](const Two& a) { return a.first(); });
    }
  };

  [[nodiscard]] static Two3 both(const SplitVector<Scalar>& a, const SplitVector<Scalar>& b) noexcept {
    return {firsts(a.xy, b.xy), seconds(a.xy, b.xy), Two(a.z, b.z)};
  }

  Two3 tip_;
  Two3 u_;
  std::array<Joints, (kCapacity<N> + 1) / 2> joints_;
};

}  // namespace fpbm
