#pragma once

#include "fpbm/core/sincos.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/core/validation.hpp"
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
  explicit PlanarArm(const Vector<N, Scalar>& lengths) : lengths_(lengths) {
    static_assert(N == Eigen::Dynamic || (N >= 2 && N <= kMaxDof), "a planar arm has 2 to kMaxDof joints");
    validation::require_dof("lengths", lengths.size(), Position<2>::kRows);
    validation::require_positive("lengths", lengths);
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(lengths_.size()); }
  [[nodiscard]] const Vector<N, Scalar>& lengths() const noexcept { return lengths_; }

  /// Tip position and J at q; leaves Jd alone.
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Position<2>, N, Scalar>& out) const noexcept {
    sweep<false>(q, q, out);
  }

  /// Tip position, J and Jd at (q, qd).
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Position<2>, N, Scalar>& out) const noexcept {
    sweep<true>(q, qd, out);
  }

 private:
  /// One pass out along the arm for the links, one pass back for the sums over all links beyond a joint:
  /// column j of J is Σ_{i≥j} lᵢ (−sin θᵢ, cos θᵢ), column j of Jd is −Σ_{i≥j} θ̇ᵢ lᵢ (cos θᵢ, sin θᵢ).
  template <bool kWithRate>
  [[gnu::flatten]] void sweep(const Vector<N, Scalar>& q, [[maybe_unused]] const Vector<N, Scalar>& qd,
                              Kinematics<Position<2>, N, Scalar>& out) const noexcept {
    const Eigen::Index n = lengths_.size();
    out.J.resize(2, n);
    if constexpr (kWithRate) out.Jd.resize(2, n);

    Vector<N, Scalar> angles = q;
    for (Eigen::Index i = 1; i < n; ++i) angles(i) += angles(i - 1);
    Vector<N, Scalar> sines;
    Vector<N, Scalar> cosines;
    sincos(angles, sines, cosines);

    [[maybe_unused]] Scalar rate(0);
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
      out.J.col(i) += out.J.col(i + 1);
      if constexpr (kWithRate) out.Jd.col(i) += out.Jd.col(i + 1);
    }
    out.tip(0) = out.J(1, 0);
    out.tip(1) = -out.J(0, 0);
  }

  Vector<N, Scalar> lengths_;
};

}  // namespace fpbm
