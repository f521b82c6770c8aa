#include "support/textbook.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace fpbm::test {
namespace {

bool is_velocity(Kind kind) {
  return kind == Kind::kMVN || kind == Kind::kWMVN;
}

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

RealMatrix pseudoinverse(const RealMatrix& J) {
  return Eigen::CompleteOrthogonalDecomposition<RealMatrix>(J).pseudoInverse();
}

RealMatrix weighted_pseudoinverse(const RealMatrix& J, const RealMatrix& W) {
  const RealMatrix WinvJt = W.inverse() * J.transpose();
  return WinvJt * (J * WinvJt).inverse();
}

RealMatrix projector(const RealMatrix& J, const RealMatrix& W) {
  return identity(J) - weighted_pseudoinverse(J, W) * J;
}

RealMatrix rate_term(const RealMatrix& J, const RealMatrix& Jd, const RealMatrix& W) {
  const RealMatrix Winv = W.inverse();
  return projector(J, W) * Winv * Jd.transpose() * (J * Winv * J.transpose()).inverse();
}

RealVector commanded(const Law& law, const Situation& at) {
  if (is_velocity(law.kind)) return at.xd + static_cast<Real>(law.k) * at.error;
  RealVector b = at.xdd - at.Jd * at.qd;
  if (law.kind == Kind::kFPBM) {
    b += static_cast<Real>(law.k1) * (at.xd - at.J * at.qd) + static_cast<Real>(law.k2) * at.error;
  }
  return b;
}

RealVector secondary(const Law& law, const Situation& at) {
  if (!law.has_null_space) return RealVector::Zero(at.q.size());
  RealVector z = real(law.c) + static_cast<Real>(law.stiffness) * (real(law.q_rest) - at.q);
  if (!is_velocity(law.kind)) z -= static_cast<Real>(law.damping) * at.qd;
  return z;
}

RealVector resolve(const Law& law, const Situation& at) {
  const RealMatrix W = real(law.W);
  const RealVector b = commanded(law, at);
  const RealVector z = secondary(law, at);
  const RealMatrix Jp = pseudoinverse(at.J);
  const RealMatrix JWp = weighted_pseudoinverse(at.J, W);
  const RealVector man = Jp * b;
  const RealVector wmvn = JWp * b + rate_term(at.J, at.Jd, W) * at.xd;
  const auto alpha = static_cast<Real>(law.alpha);
  switch (law.kind) {
    case Kind::kMVN:
    case Kind::kMAN: return man + (identity(at.J) - Jp * at.J) * z;
    case Kind::kWMVN: return JWp * b + projector(at.J, W) * z;
    case Kind::kWMVNAcceleration: return wmvn + projector(at.J, W) * z;
    case Kind::kBalanced:
    case Kind::kFPBM: return (1 - alpha) * man + alpha * wmvn + projector(at.J, W) * z;
  }
  return {};
}

}  // namespace fpbm::test
