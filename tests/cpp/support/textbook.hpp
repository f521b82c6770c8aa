#pragma once

#include <Eigen/Core>

/// A second implementation of the mathematics of the paper, without the library: as printed, with explicit
/// pseudoinverses and projectors, in extended precision.
namespace fpbm::test {

using Real = long double;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

template <typename Derived>
[[nodiscard]] RealMatrix real(const Eigen::MatrixBase<Derived>& values) {
  return values.template cast<Real>();
}

/// Every scheme of the paper, by its parameters. Parameters that a scheme does not have are neutral.
struct Law {
  bool acceleration = false;  ///< Whether the law gives qdd. Otherwise, the law gives qd.
  double alpha = 0.0;         ///< Weight of the weighted pseudoinverse: 0 in MVN and MAN, 1 in WMVN at both levels.
  double k = 0.0;             ///< Feedback gain at velocity level.
  double k1 = 0.0;            ///< Feedback gains at acceleration level.
  double k2 = 0.0;
  Eigen::MatrixXd W;
  bool has_null_space = false;
  double damping = 0.0;
  double stiffness = 0.0;
  Eigen::VectorXd q_rest;
  Eigen::VectorXd c;
  double singular_radius = 0.0;  ///< Fraction of ‖J‖_F below which the library damps; this header never damps.
  double singular_brake = 0.0;
};

/// An arm in a state, and the reference of its tip.
struct Situation {
  RealVector q;
  RealVector qd;
  RealVector tip;
  RealMatrix J;
  RealMatrix Jd;
  RealVector error;  ///< x ⊖ f(q).
  RealVector xd;
  RealVector xdd;
  RealVector units;  ///< Unit of each row: 1 for a length, the characteristic length of the arm for an angle.
};

/// Tip position, J and Jd of a planar arm at (q, qd), with a separate sum for each element. The reference is empty.
[[nodiscard]] Situation planar_arm(const RealVector& lengths, const RealVector& q, const RealVector& qd);

/// Singular values of J in decreasing order, and its left singular vectors.
struct Spectrum {
  RealVector sigma;
  RealMatrix U;
};
[[nodiscard]] Spectrum spectrum(const RealMatrix& J);
[[nodiscard]] RealVector singular_values(const RealMatrix& J);

[[nodiscard]] RealMatrix inverse(const RealMatrix& A);
[[nodiscard]] Real determinant(const RealMatrix& A);

/// Eigenvalues of a symmetric positive semidefinite matrix, in increasing order.
[[nodiscard]] RealVector eigenvalues(const RealMatrix& A);

/// The numbers in increasing order.
[[nodiscard]] RealVector sorted(RealVector values);

/// Orthogonal matrix: Q of A = QR.
[[nodiscard]] RealMatrix orthogonal(const RealMatrix& A);

/// J⁺ of a J of full rank, from an orthogonal decomposition. The round-off error is proportional to the condition
/// number of J, not to its square.
[[nodiscard]] RealMatrix pseudoinverse(const RealMatrix& J);

/// J_W⁺ = W⁻¹Jᵀ(JW⁻¹Jᵀ)⁻¹.
[[nodiscard]] RealMatrix weighted_pseudoinverse(const RealMatrix& J, const RealMatrix& W);

/// N_W = I − J_W⁺J.
[[nodiscard]] RealMatrix projector(const RealMatrix& J, const RealMatrix& W);

/// N_W W⁻¹Jdᵀ(JW⁻¹Jᵀ)⁻¹: the factor of xd in (9), and the first term of Lemma 1.
[[nodiscard]] RealMatrix rate_term(const RealMatrix& J, const RealMatrix& Jd, const RealMatrix& W);

/// The J qd, or J qdd, that the law prescribes.
[[nodiscard]] RealVector commanded(const Law& law, const Situation& at);

/// z, before any projection.
[[nodiscard]] RealVector secondary(const Law& law, const Situation& at);

/// Joint velocities of (3), (6), (7), or joint accelerations of (5), (8), (9), (13), (16).
[[nodiscard]] RealVector resolve(const Law& law, const Situation& at);

}  // namespace fpbm::test
