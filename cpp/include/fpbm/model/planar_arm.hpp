#pragma once

#include <type_traits>

#include "fpbm/core/sincos.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Planar arm of N revolute joints: f(q) = Σᵢ lᵢ (cos θᵢ, sin θᵢ) with θᵢ = q₁ + … + qᵢ.
///
/// Joint angles are relative [rad], the first from the base frame's x axis; lengths in metres. Immutable.
/// N = Eigen::Dynamic takes the number of joints from the lengths, up to kMaxDof.
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

  /// The same arm for another Scalar.
  template <typename Other>
  [[nodiscard]] PlanarArm<N, Other> cast() const {
    return PlanarArm<N, Other>(lengths_.template cast<Other>());
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(lengths_.size()); }
  [[nodiscard]] const Vector<N, Scalar>& lengths() const noexcept { return lengths_; }

  /// Characteristic length: the reach [m].
  [[nodiscard]] Scalar length() const noexcept { return reach_; }

  /// Unbounded.
  [[nodiscard]] JointLimits<N, Scalar> limits() const { return JointLimits<N, Scalar>::none(lengths_.size()); }

  /// Tip and J at q, for the task spaces Position<2> and PlanarPose; does not touch Jd.
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
  /// A pass to the tip for the links, a pass back for the sums over all links beyond a joint:
  /// column j of J is Σ_{i≥j} lᵢ (−sin θᵢ, cos θᵢ), column j of Jd is −Σ_{i≥j} θ̇ᵢ lᵢ (cos θᵢ, sin θᵢ).
  /// The tip's angle is θₙ.
  template <bool kWithRate, typename Space>
  [[gnu::flatten]] void forward_pass(const Vector<N, Scalar>& q, [[maybe_unused]] const Vector<N, Scalar>& qd,
                                     Kinematics<Space, N, Scalar>& out) const noexcept {
    constexpr bool kWithOrientation = std::is_same_v<Space, PlanarPose>;
    static_assert(kWithOrientation || std::is_same_v<Space, Position<2>>,
                  "a planar arm has tasks Position<2> and PlanarPose");
    const Eigen::Index n = lengths_.size();
    out.J.resize(Space::kRows, n);
    if constexpr (kWithRate) out.Jd.resize(Space::kRows, n);

    Vector<N, Scalar> angles = q;
    for (Eigen::Index i = 1; i < n; ++i) angles(i) += angles(i - 1);
    Vector<N, Scalar> sines;
    Vector<N, Scalar> cosines;
    sincos(angles, sines, cosines);

    [[maybe_unused]] Scalar rate(0);  // Of the link's angle.
    for (Eigen::Index i = 0; i < n; ++i) {
      const Scalar x = lengths_(i) * cosines(i);
      const Scalar y = lengths_(i) * sines(i);
      out.J(0, i) = -y;
      out.J(1, i) = x;
      if constexpr (kWithRate) {
        rate += qd(i);
        out.Jd(0, i) = -rate * x;
        out.Jd(1, i) = -rate * y;
      }
    }
    for (Eigen::Index i = n - 2; i >= 0; --i) {
      out.J.col(i).template head<2>() += out.J.col(i + 1).template head<2>();
      if constexpr (kWithRate) out.Jd.col(i).template head<2>() += out.Jd.col(i + 1).template head<2>();
    }
    out.length = reach_;
    out.tip(0) = out.J(1, 0);
    out.tip(1) = -out.J(0, 0);
    if constexpr (kWithOrientation) {
      out.tip(2) = angles(n - 1);
      out.J.row(2).setOnes();
      if constexpr (kWithRate) out.Jd.row(2).setZero();
    }
  }

  Vector<N, Scalar> lengths_;
  Scalar reach_;
};

}  // namespace fpbm
