#pragma once

#include <type_traits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/detail/sincos.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Planar arm of N revolute joints: f(q) = Σᵢ lᵢ (cos θᵢ, sin θᵢ) with θᵢ = q₁ + … + qᵢ.
///
/// Joint angles [rad] are relative to the previous link. The first angle is relative to the x axis of the base frame.
/// Lengths are in metres. Immutable.
/// With N = Eigen::Dynamic, the number of lengths is the number of joints, up to kMaxDof.
template <int N, typename Scalar_ = double>
class PlanarArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// Throws std::invalid_argument unless there are 2 to kMaxDof lengths, all positive and finite.
  explicit PlanarArm(const Vector<N, Scalar>& lengths) : lengths_(lengths), reach_(lengths.sum()) {
    static_assert(N == Eigen::Dynamic || (N >= 2 && N <= kMaxDof), "a planar arm has 2 to kMaxDof joints");
    validation::require_dof("lengths", lengths.size(), Position<2>::kRows);
    validation::require_positive("lengths", lengths);
  }

  /// This arm with another Scalar.
  template <typename Other>
  [[nodiscard]] PlanarArm<N, Other> cast() const {
    return PlanarArm<N, Other>(lengths_.template cast<Other>());
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(lengths_.size()); }
  [[nodiscard]] const Vector<N, Scalar>& lengths() const noexcept { return lengths_; }

  /// Characteristic length: the sum of the lengths of the links [m].
  [[nodiscard]] Scalar length() const noexcept { return reach_; }

  /// Limits without bounds: all joints are continuous.
  [[nodiscard]] JointLimits<N, Scalar> limits() const {
    auto limits = JointLimits<N, Scalar>::none(lengths_.size());
    for (Eigen::Index i = 0; i < lengths_.size(); ++i) limits.continuous |= joint_bit(i);
    return limits;
  }

  /// Tip and J at q, for the task spaces Position<2> and PlanarPose. Jd does not change.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    forward_pass<false>(q, q, out);
  }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<2> and PlanarPose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    forward_pass<true>(q, qd, out);
  }

 private:
  using Two = Pair<Scalar>;

  /// The pass from base to tip computes the angles of the links. The pass back computes the sums over all links beyond
  /// a joint: column j of J is Σ_{i≥j} lᵢ (−sin θᵢ, cos θᵢ), column j of Jd is −Σ_{i≥j} θ̇ᵢ lᵢ (cos θᵢ, sin θᵢ).
  /// The angle of the tip is θₙ.
  template <bool kWithRate, typename Space>
  [[gnu::flatten, gnu::noinline]] void forward_pass(const Vector<N, Scalar>& q,
                                                    [[maybe_unused]] const Vector<N, Scalar>& qd,
                                                    Kinematics<Space, N, Scalar>& out) const noexcept {
    constexpr bool kWithOrientation = std::is_same_v<Space, PlanarPose>;
    static_assert(kWithOrientation || std::is_same_v<Space, Position<2>>,
                  "a planar arm needs Position<2> or PlanarPose as Space");
    const auto n = extent<N>(lengths_.size());
    const auto pairs = pairs_of(n);
    out.J.resize(Space::kRows, n);
    if constexpr (kWithRate) out.Jd.resize(Space::kRows, n);

    const Angles<N, Scalar> angles = running_sum(q);
    Angles<N, Scalar> sines;
    Angles<N, Scalar> cosines;
    sincos(angles, sines, cosines);
    [[maybe_unused]] Angles<N, Scalar> rates;
    if constexpr (kWithRate) rates = running_sum(qd);

    Two column(Scalar(0));
    [[maybe_unused]] Two column_rate(Scalar(0));
    each(Constant<0>{}, pairs, [&](auto k) {
      const Eigen::Index i = 2 * (pairs - 1 - Eigen::Index(k));
      const Two lengths = two_of(lengths_, i);
      const Two x = lengths * two_of(cosines, i);
      const Two y = lengths * two_of(sines, i);
      const Two back = Two(Scalar(0)) - y;
      if (i + 1 < n) {
        column += seconds(back, x);
        column.store(&out.J.coeffRef(0, i + 1));
      }
      column += firsts(back, x);
      column.store(&out.J.coeffRef(0, i));
      if constexpr (kWithRate) {
        const Two rate = two_of(rates, i);
        const Two xd = rate * x;
        const Two yd = rate * y;
        if (i + 1 < n) {
          column_rate -= seconds(xd, yd);
          column_rate.store(&out.Jd.coeffRef(0, i + 1));
        }
        column_rate -= firsts(xd, yd);
        column_rate.store(&out.Jd.coeffRef(0, i));
      }
    });
    out.length = reach_;
    Two(column.second(), -column.first()).store(&out.tip.coeffRef(0));
    if constexpr (kWithOrientation) {
      out.tip(2) = angles(n - 1);
      out.J.row(2).setOnes();
      if constexpr (kWithRate) out.Jd.row(2).setZero();
    }
  }

  /// Cumulative sums of the entries.
  [[nodiscard]] static Angles<N, Scalar> running_sum(const Vector<N, Scalar>& of) noexcept {
    Angles<N, Scalar> result = angles_of<N, Scalar>(of.size());
    Scalar sum(0);
    each(Constant<0>{}, pairs_of(extent<N>(of.size())), [&](auto k) {
      const Eigen::Index i = 2 * Eigen::Index(k);
      const Two terms = two_of(of, i);
      const Scalar first = sum + terms.first();
      sum = first + terms.second();
      set_two_of(result, i, Two(first, sum));
    });
    return result;
  }

  Vector<N, Scalar> lengths_;
  Scalar reach_;
};

}  // namespace fpbm
