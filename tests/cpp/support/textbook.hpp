#pragma once

#include <Eigen/Core>

/// The same mathematics a second time: as printed, with pseudoinverses and projectors formed, in extended precision,
/// and with nothing of the library in it.
namespace fpbm::test {

using Real = long double;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

template <typename Derived>
[[nodiscard]] RealMatrix real(const Eigen::MatrixBase<Derived>& values) {
  return values.template cast<Real>();
}

enum class Kind { kMVN, kWMVN, kMAN, kWMVNAcceleration, kBalanced, kFPBM };

/// A scheme with all that any of them can be told.
struct Law {
  Kind kind;
  double alpha = 0.0;
  double k = 0.0;
  double k1 = 0.0;
  double k2 = 0.0;
  Eigen::MatrixXd W;
  bool has_null_space = false;
  double damping = 0.0;
  double stiffness = 0.0;
  Eigen::VectorXd q_rest;
  Eigen::VectorXd c;
  double singular_radius = 0.0;  ///< Share of ‖J‖_F below which the schemes damp; the laws here never do.
  double singular_brake = 0.0;
};

/// An arm in a state, and what is asked of its tip.
struct Situation {
  RealVector q;
  RealVector qd;
  RealVector tip;
  RealMatrix J;
  RealMatrix Jd;
  RealVector error;  ///< x ⊖ f(q).
  RealVector xd;
  RealVector xdd;
};

/// Tip position, J and Jd of a planar arm, each element summed on its own; q and qd as given, the rest left alone.
[[nodiscard]] Situation planar_arm(const RealVector& lengths, const RealVector& q, const RealVector& qd);

/// J⁺, from an orthogonal decomposition, whose round-off goes by the condition of J and not by its square.
[[nodiscard]] RealMatrix pseudoinverse(const RealMatrix& J);

/// J_W⁺ = W⁻¹Jᵀ(JW⁻¹Jᵀ)⁻¹.
[[nodiscard]] RealMatrix weighted_pseudoinverse(const RealMatrix& J, const RealMatrix& W);

/// N_W = I − J_W⁺J.
[[nodiscard]] RealMatrix projector(const RealMatrix& J, const RealMatrix& W);

/// N_W W⁻¹Jdᵀ(JW⁻¹Jᵀ)⁻¹: what (9) has beside J_W⁺, and the first half of Lemma 1.
[[nodiscard]] RealMatrix rate_term(const RealMatrix& J, const RealMatrix& Jd, const RealMatrix& W);

/// What J qd, or J qdd, is to be.
[[nodiscard]] RealVector commanded(const Law& law, const Situation& at);

/// z, before any projection.
[[nodiscard]] RealVector secondary(const Law& law, const Situation& at);

/// Joint velocities of (3), (6), (7), or joint accelerations of (5), (8), (9), (13), (16).
[[nodiscard]] RealVector resolve(const Law& law, const Situation& at);

}  // namespace fpbm::test
