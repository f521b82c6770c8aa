#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "cases.hpp"

// The schemes on a peer's kinematics, in typical Eigen code: fixed sizes, Cholesky factorisations instead of the
// paper's pseudoinverses.
namespace bench {

/// Tip, J and Jd, linear rows first, along the axes of the base frame, at the tip.
template <typename Case>
struct Motion {
  Eigen::Matrix3d R;  ///< For poses only.
  Eigen::Vector3d p;
  Eigen::Matrix<double, Case::kRows, Case::kDof> J;
  Eigen::Matrix<double, Case::kRows, Case::kDof> Jd;
};

/// A step of Kinematics<Case>, which has move<kWithRate>(state, motion), with the scheme in Eigen.
template <template <typename> class Kinematics, typename Case_, Law law>
class Textbook {
 public:
  using Case = Case_;
  static constexpr int N = Case::kDof;
  static constexpr int M = Case::kRows;
  static constexpr Law kLaw = law;
  static constexpr const char* kLibrary = Kinematics<Case>::kLibrary;

  void move(const Input<typename Case::Space, N>& input) {
    kinematics_.template move<is_acceleration(law)>(input.state, motion_);
  }

  fpbm::Status resolve(const Input<typename Case::Space, N>& input, fpbm::Vector<N>& out) const {
    const auto& [R, p, J, Jd] = motion_;
    const Joints qd = input.state.qd;
    const Rows xd = input.reference.xd;
    const Eigen::Matrix<double, N, M> Jt = J.transpose();
    const Eigen::Matrix<double, N, M> WinvJt = inverse_.asDiagonal() * Jt;
    if constexpr (law == Law::kMVN) {
      out = Jt * Cholesky(J * Jt).solve(xd + kGain * error(input));
    } else if constexpr (law == Law::kWMVN) {
      out = WinvJt * Cholesky(J * WinvJt).solve(xd + kGain * error(input));
    } else {
      Rows b = input.reference.xdd - Jd * qd;
      if constexpr (law == Law::kFPBM) b += kGain1 * (xd - J * qd) + kGain2 * error(input);
      if constexpr (law == Law::kMAN) {
        out = Jt * Cholesky(J * Jt).solve(b);
      } else {
        constexpr double alpha = law == Law::kWMVNAcceleration ? 1.0 : kAlpha;
        const Cholesky weighted(J * WinvJt);
        const Joints u = alpha * inverse_.cwiseProduct(Jd.transpose() * weighted.solve(xd));
        const Rows rest = alpha * b - J * u;
        out = u + WinvJt * weighted.solve(rest);
        if constexpr (alpha < 1.0) out += (1.0 - alpha) * (Jt * Cholesky(J * Jt).solve(b));
      }
    }
    return fpbm::Status::kOk;
  }

  [[nodiscard]] const auto& J() const { return motion_.J; }

 private:
  using Joints = Eigen::Matrix<double, N, 1>;
  using Rows = Eigen::Matrix<double, M, 1>;
  using Cholesky = Eigen::LLT<Eigen::Matrix<double, M, M>>;

  Rows error(const Input<typename Case::Space, N>& input) const {
    const auto& x = input.reference.x;
    if constexpr (Case::kWithOrientation) {
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(x.R * motion_.R.transpose()));
      return (Rows() << x.p - motion_.p, turn.angle() * turn.axis()).finished();
    } else {
      return x - motion_.p.template head<M>();
    }
  }

  Kinematics<Case> kinematics_;
  Motion<Case> motion_;
  Joints inverse_ = weights<N>().cwiseInverse();
};

}  // namespace bench
