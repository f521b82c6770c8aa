#pragma once

#include <Eigen/QR>

#include "stack_levels.hpp"
#include "stack_qp.hpp"

// A stack as a cascade of quadratic programs (hierarchical QP) on Pinocchio's kinematics. Level k is
//
//   min ½ ‖J_k u − b_k‖² + ½ ε ‖u − u_{k−1}‖²,  J_i u = J_i u_i for i < k,  lower ≤ u ≤ upper.
//
// There are two formulations: with these equalities (Equalities), or u = u_{k−1} + Z z, where Z is a basis of the null
// space of J_1 … J_{k−1} (NullSpaces). The box is Limits::box(), widened by the round-off error of u_{k−1}, so that
// u_{k−1} is feasible. If a program has no solution nevertheless, the level keeps u_{k−1}.
namespace bench::stack {

constexpr double kRegularisation = 1e-8;

/// With the motion of higher levels as equalities.
template <typename Case, template <int, int, int> class Qp>
class Equalities {
 public:
  static std::string name() { return std::string("equalities, ") + Qp<1, 1, 1>::kName; }

  Equalities() {
    for_each([](auto& qp) {
      qp.CI.template topRows<N>().setIdentity();
      qp.CI.template bottomRows<N>() = -Eigen::Matrix<double, N, N>::Identity();
    });
    if constexpr (kFree > 0) third_.H.setIdentity();
  }

  [[gnu::noinline]] void operator()(const Asked<Case>& asked, Joints& u) {
    levels_.update(asked);
    const auto box = limits_.box(asked.state);
    u = box.nearest(asked.last);
    minimise(first_, levels_.J0, levels_.b0, u);
    take(first_, box, u);
    second_.CE = levels_.J0;
    second_.ce = -levels_.J0 * u;
    minimise(second_, levels_.J1, levels_.b1, u);
    take(second_, box, u);
    if constexpr (kFree > 0) {
      third_.CE.template topRows<M0>() = levels_.J0;
      third_.CE.template bottomRows<M1>() = levels_.J1;
      third_.ce = -third_.CE * u;
      third_.g = -levels_.b2;
      take(third_, box, u);
    }
  }

  [[nodiscard]] long unsolved() const noexcept { return unsolved_; }

 private:
  static constexpr int M0 = Case::kRows;
  static constexpr int M1 = Case::kElbowRows;
  /// Degrees of freedom of the posture; none if tip and elbow determine all joints.
  static constexpr int kFree = N - M0 - Case::kElbowRank;

  template <typename F>
  void for_each(F&& f) {
    f(first_);
    f(second_);
    if constexpr (kFree > 0) f(third_);
  }

  template <typename Program, typename J, typename B>
  static void minimise(Program& qp, const J& rows, const B& b, const Joints& last) {
    qp.H.noalias() = rows.transpose() * rows;
    qp.H.diagonal().array() += kRegularisation;
    qp.g.noalias() = -rows.transpose() * b;
    qp.g -= kRegularisation * last;
  }

  template <typename Program>
  void take(Program& qp, const fpbm::Box<N>& box, Joints& u) {
    qp.ci.template head<N>() = -box.lower.cwiseMin(u);
    qp.ci.template tail<N>() = box.upper.cwiseMax(u);
    if (qp.solve()) {
      u = qp.x;
    } else {
      ++unsolved_;
    }
  }

  CascadeLevels<Case> levels_;
  Limits limits_ = limits();
  Qp<N, 0, 2 * N> first_;
  Qp<N, M0, 2 * N> second_;
  std::conditional_t<(kFree > 0), Qp<N, M0 + M1, 2 * N>, int> third_;
  long unsolved_ = 0;
};

/// In the null spaces of higher levels.
template <typename Case, template <int, int, int> class Qp>
class NullSpaces {
 public:
  static std::string name() { return std::string("null spaces, ") + Qp<1, 1, 1>::kName; }

  NullSpaces() {
    first_.CI.template topRows<N>().setIdentity();
    first_.CI.template bottomRows<N>() = -Eigen::Matrix<double, N, N>::Identity();
    if constexpr (kFree > 0) third_.H.setIdentity();
  }

  [[gnu::noinline]] void operator()(const Asked<Case>& asked, Joints& u) {
    levels_.update(asked);
    const auto box = limits_.box(asked.state);
    u = box.nearest(asked.last);
    first_.H.noalias() = levels_.J0.transpose() * levels_.J0;
    first_.H.diagonal().array() += kRegularisation;
    first_.g.noalias() = -levels_.J0.transpose() * levels_.b0;
    first_.g -= kRegularisation * u;
    first_.ci.template head<N>() = -box.lower;
    first_.ci.template tail<N>() = box.upper;
    if (first_.solve()) {
      u = first_.x;
    } else {
      ++unsolved_;
    }
    const Eigen::Matrix<double, N, kBelow> Z = basis<M0>(levels_.J0);
    const Eigen::Matrix<double, M1, kBelow> J1 = levels_.J1 * Z;
    second_.H.noalias() = J1.transpose() * J1;
    second_.H.diagonal().array() += kRegularisation;
    second_.g.noalias() = -J1.transpose() * (levels_.b1 - levels_.J1 * u);
    move(second_, Z, box, u);
    if constexpr (kFree > 0) {
      const Eigen::Matrix<double, N, kFree> Z2 = Z * basis<M1>(J1);
      third_.g.noalias() = -Z2.transpose() * (levels_.b2 - u);
      move(third_, Z2, box, u);
    }
  }

  [[nodiscard]] long unsolved() const noexcept { return unsolved_; }

 private:
  static constexpr int M0 = Case::kRows;
  static constexpr int M1 = Case::kElbowRows;
  static constexpr int kBelow = N - M0;
  static constexpr int kFree = kBelow - Case::kElbowRank;

  /// Orthonormal basis of the null space of M rows.
  template <int M, typename J>
  static auto basis(const J& rows) {
    constexpr int n = J::ColsAtCompileTime;
    const Eigen::HouseholderQR<Eigen::Matrix<double, n, M>> qr(rows.transpose());
    const Eigen::Matrix<double, n, n> Q = qr.householderQ();
    return Eigen::Matrix<double, n, n - M>(Q.template rightCols<n - M>());
  }

  /// Adds Z z within the box, with z from the program.
  template <typename Program, typename Basis>
  void move(Program& qp, const Basis& Z, const fpbm::Box<N>& box, Joints& u) {
    qp.CI.template topRows<N>() = Z;
    qp.CI.template bottomRows<N>() = -Z;
    qp.ci.template head<N>() = (u - box.lower).cwiseMax(0.0);
    qp.ci.template tail<N>() = (box.upper - u).cwiseMax(0.0);
    if (qp.solve()) {
      u += Z * qp.x;
    } else {
      ++unsolved_;
    }
  }

  CascadeLevels<Case> levels_;
  Limits limits_ = limits();
  Qp<N, 0, 2 * N> first_;
  Qp<kBelow, 0, 2 * N> second_;
  std::conditional_t<(kFree > 0), Qp<kFree, 0, 2 * N>, int> third_;
  long unsolved_ = 0;
};

}  // namespace bench::stack
