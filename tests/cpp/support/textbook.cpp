#include "support/textbook.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace fpbm::test {
namespace {

RealMatrix identity(const RealMatrix& J) {
  return RealMatrix::Identity(J.cols(), J.cols());
}

// The decompositions are short: Eigen's, in extended precision, take ten times as long to compile.

/// Gauss-Jordan elimination with the largest pivot of each column: transforms A to I and B to A⁻¹B. Returns det A.
Real eliminate(RealMatrix A, RealMatrix& B) {
  Real product = 1;
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < A.rows(); ++i) {
      if (std::abs(A(i, k)) > std::abs(A(pivot, k))) pivot = i;
    }
    if (pivot != k) {
      product = -product;
      A.row(k).swap(A.row(pivot));
      B.row(k).swap(B.row(pivot));
    }
    product *= A(k, k);
    const Real scale = 1 / A(k, k);
    A.row(k) *= scale;
    B.row(k) *= scale;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const Real factor = i == k ? 0 : A(i, k);
      if (factor == 0) continue;
      A.row(i) -= factor * A.row(k);
      B.row(i) -= factor * B.row(k);
    }
  }
  return product;
}

/// A = QR by Gram-Schmidt. Each column is orthogonalised twice, so that Q is accurate to round-off.
std::pair<RealMatrix, RealMatrix> qr(const RealMatrix& A) {
  RealMatrix Q = A;
  RealMatrix R = RealMatrix::Zero(A.cols(), A.cols());
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index i = 0; i < k; ++i) {
        const Real along = Q.col(i).dot(Q.col(k));
        Q.col(k) -= along * Q.col(i);
        R(i, k) += along;
      }
    }
    R(k, k) = Q.col(k).norm();
    Q.col(k) /= R(k, k);
  }
  return {Q, R};
}

/// Jacobi rotations: orthogonalises the rows of A in pairs, and rotates the columns of U accordingly, so that UA is
/// constant. Small singular values are as accurate as large ones.
void make_rows_orthogonal(RealMatrix& A, RealMatrix& U) {
  bool turned = true;
  for (int sweep = 0; turned && sweep < 40; ++sweep) {  // Rows of round-off error never become orthogonal.
    turned = false;
    for (Eigen::Index i = 0; i + 1 < A.rows(); ++i) {
      for (Eigen::Index j = i + 1; j < A.rows(); ++j) {
        const Real ii = A.row(i).squaredNorm();
        const Real jj = A.row(j).squaredNorm();
        const Real ij = A.row(i).dot(A.row(j));
        if (!(std::abs(ij) > 16 * std::numeric_limits<Real>::epsilon() * std::sqrt(ii * jj))) continue;
        turned = true;
        const Real zeta = (jj - ii) / (2 * ij);
        const Real t = (zeta < 0 ? -1 : 1) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
        const Real c = 1 / std::sqrt(1 + t * t);
        const RealMatrix row = c * A.row(i) - c * t * A.row(j);
        A.row(j) = c * t * A.row(i) + c * A.row(j);
        A.row(i) = row;
        const RealMatrix column = c * U.col(i) - c * t * U.col(j);
        U.col(j) = c * t * U.col(i) + c * U.col(j);
        U.col(i) = column;
      }
    }
  }
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
  RealMatrix A = J;
  RealMatrix U = RealMatrix::Identity(J.rows(), J.rows());
  make_rows_orthogonal(A, U);
  std::vector<std::pair<Real, Eigen::Index>> order;
  for (Eigen::Index i = 0; i < A.rows(); ++i) order.emplace_back(A.row(i).norm(), i);
  std::sort(order.begin(), order.end(), std::greater<>());
  Spectrum found{RealVector(J.rows()), U};
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    const auto& [sigma, from] = order[static_cast<std::size_t>(i)];
    found.sigma(i) = sigma;
    found.U.col(i) = U.col(from);
  }
  return found;
}

RealVector singular_values(const RealMatrix& J) {
  if (J.rows() > J.cols()) return spectrum(J.transpose()).sigma;
  return spectrum(J).sigma;
}

RealMatrix orthogonal(const RealMatrix& A) {
  return qr(A).first;
}

RealMatrix inverse(const RealMatrix& A) {
  RealMatrix result = identity(A);
  eliminate(A, result);
  return result;
}

Real determinant(const RealMatrix& A) {
  RealMatrix nothing(A.rows(), 0);
  return eliminate(A, nothing);
}

RealVector eigenvalues(const RealMatrix& A) {
  return sorted(singular_values(A));
}

RealVector sorted(RealVector values) {
  std::sort(values.begin(), values.end());
  return values;
}

RealMatrix pseudoinverse(const RealMatrix& J) {
  const auto [Q, R] = qr(J.transpose());  // Jᵀ = QR: J⁺ = Q R⁻ᵀ.
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
