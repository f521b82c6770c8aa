#include "support/textbook.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace fpbm::test {
namespace {

RealMatrix identity(const RealMatrix& J) {
  return RealMatrix::Identity(J.cols(), J.cols());
}

}  // namespace

Situation planar_arm(const RealVector& lengths, const RealVector& q, const RealVector& qd) {
  const Eigen::Index n = q.size();
  Situation at;
  at.q = q;
  at.qd = qd;
  at.tip = RealVector::Zero(2);
  at.J = RealMatrix::Zero(2, n);
  at.Jd = RealMatrix::Zero(2, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Real angle = q.head(i + 1).sum();
    const Real rate = qd.head(i + 1).sum();
    const Real c = lengths(i) * std::cos(angle);
    const Real s = lengths(i) * std::sin(angle);
    at.tip += RealVector{{c, s}};
    for (Eigen::Index j = 0; j <= i; ++j) {
      at.J.col(j) += RealVector{{-s, c}};
      at.Jd.col(j) += rate * RealVector{{-c, -s}};
    }
  }
  return at;
}

Spectrum spectrum(const RealMatrix& J) {
  const Eigen::JacobiSVD<RealMatrix, Eigen::HouseholderQRPreconditioner> svd(J, Eigen::ComputeFullU);
  return {svd.singularValues(), svd.matrixU()};
}

RealVector singular_values(const RealMatrix& J) {
  return spectrum(J).sigma;
}

RealMatrix orthogonal(const RealMatrix& A) {
  return Eigen::HouseholderQR<RealMatrix>(A).householderQ();
}

RealMatrix inverse(const RealMatrix& A) {
  return A.inverse();
}

Real determinant(const RealMatrix& A) {
  return A.determinant();
}

RealVector eigenvalues(const RealMatrix& A) {
  return Eigen::SelfAdjointEigenSolver<RealMatrix>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

RealVector sorted(RealVector values) {
  std::sort(values.begin(), values.end());
  return values;
}

RealMatrix pseudoinverse(const RealMatrix& J) {
  const Eigen::HouseholderQR<RealMatrix> qr(J.transpose());  // Jᵀ = QR: J⁺ = Q R⁻ᵀ.
  const RealMatrix Q = qr.householderQ() * RealMatrix::Identity(J.cols(), J.rows());
  const RealMatrix R = qr.matrixQR().topRows(J.rows()).triangularView<Eigen::Upper>();
  return Q * inverse(R.transpose());
}

RealMatrix weighted_pseudoinverse(const RealMatrix& J, const RealMatrix& W) {
  const RealMatrix WinvJt = inverse(W) * J.transpose();
  return WinvJt * inverse(J * WinvJt);
}

RealMatrix projector(const RealMatrix& J, const RealMatrix& W) {
  return identity(J) - weighted_pseudoinverse(J, W) * J;
}

RealMatrix rate_term(const RealMatrix& J, const RealMatrix& Jd, const RealMatrix& W) {
  const RealMatrix Winv = inverse(W);
  return projector(J, W) * Winv * Jd.transpose() * inverse(J * Winv * J.transpose());
}

RealVector commanded(const Law& law, const Situation& at) {
  if (!law.acceleration) return at.xd + static_cast<Real>(law.k) * at.error;
  return at.xdd - at.Jd * at.qd + static_cast<Real>(law.k1) * (at.xd - at.J * at.qd) +
         static_cast<Real>(law.k2) * at.error;
}

RealVector secondary(const Law& law, const Situation& at) {
  if (!law.has_null_space) return RealVector::Zero(at.q.size());
  RealVector z = real(law.c) + static_cast<Real>(law.stiffness) * (real(law.q_rest) - at.q);
  if (law.acceleration) z -= static_cast<Real>(law.damping) * at.qd;
  return z;
}

RealVector resolve(const Law& law, const Situation& at) {
  const RealMatrix W = real(law.W);
  const RealVector b = commanded(law, at);
  const RealVector unweighted = pseudoinverse(at.J) * b;
  RealVector weighted = weighted_pseudoinverse(at.J, W) * b;
  if (law.acceleration) weighted += rate_term(at.J, at.Jd, W) * at.xd;
  const auto alpha = static_cast<Real>(law.alpha);
  return (1 - alpha) * unweighted + alpha * weighted + projector(at.J, W) * secondary(law, at);
}

}  // namespace fpbm::test
