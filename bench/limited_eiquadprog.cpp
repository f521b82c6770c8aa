#include <eiquadprog/eiquadprog-fast.hpp>
#include <eiquadprog/eiquadprog-rt.hpp>

#include "limited.hpp"
#include "pinocchio_kinematics.hpp"
#include "textbook.hpp"

// The joint limits as a quadratic program, with Pinocchio's kinematics and the scheme in Eigen. In the unit of each
// joint, its acceleration bound, z = (u − from)/unit and g = (desired − from)/unit:
//
//   min ½ ‖z − g‖² + ½ w (1 − s)²,  J z = s J g,  lower ≤ z ≤ upper,  0 ≤ s ≤ 1.
//
// This library computes the box and the motion `from` in the box, because a QP library has no functions for them. With
// bounds on jerk, a step has two of these programs, as in Limiter (solve_within).
namespace bench {
namespace {

/// Sizes fixed at compile time.
template <int n, int m, int c>
class Rt {
 public:
  static constexpr const char* kName = "eiquadprog_rt";

  Eigen::Matrix<double, n, n> H = Eigen::Matrix<double, n, n>::Identity();
  Eigen::Matrix<double, n, 1> g;
  Eigen::Matrix<double, m, n> CE;
  Eigen::Matrix<double, m, 1> ce = Eigen::Matrix<double, m, 1>::Zero();
  Eigen::Matrix<double, c, n> CI = Eigen::Matrix<double, c, n>::Zero();
  Eigen::Matrix<double, c, 1> ci;
  Eigen::Matrix<double, n, 1> x;

  bool solve() { return solver_.solve_quadprog(H, g, CE, ce, CI, ci, x) == eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL; }

 private:
  eiquadprog::solvers::RtEiquadprog<n, m, c> solver_;
};

/// Sizes given at run time, in the compiled code of the library.
template <int n, int m, int c>
class Fast {
 public:
  static constexpr const char* kName = "eiquadprog_fast";
  Fast() { solver_.reset(n, m, c); }

  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd g{n};
  Eigen::MatrixXd CE{m, n};
  Eigen::VectorXd ce = Eigen::VectorXd::Zero(m);
  Eigen::MatrixXd CI = Eigen::MatrixXd::Zero(c, n);
  Eigen::VectorXd ci{c};
  Eigen::VectorXd x{n};

  bool solve() {
    return solver_.solve_quadprog(H, g, CE, ce, CI, ci, x) == eiquadprog::solvers::EIQUADPROG_FAST_OPTIMAL;
  }

 private:
  eiquadprog::solvers::EiquadprogFast solver_;
};

template <template <int, int, int> class Program, typename Case_, Bounds bounds>
class Eiquadprog {
 public:
  using Case = Case_;
  static constexpr const char* kLibrary = Program<1, 1, 1>::kName;

  Eiquadprog() {
    qp_.H(N, N) = kWeight;
    qp_.g(N) = -kWeight;
    qp_.CI.template topRows<N + 1>().setIdentity();
    qp_.CI.template bottomRows<N + 1>() = -qp_.CI.template topRows<N + 1>();
    qp_.ci(N) = 0.0;
    qp_.ci(2 * N + 1) = 1.0;
  }

  void move(const Asked<Case>& asked) {
    textbook_.move(asked);
    textbook_.resolve(asked, desired_);
  }

  bool limit(const Asked<Case>& asked, Answer<Case>& answer) {
    qp_.CE.template leftCols<N>() = textbook_.J() * unit_.asDiagonal();
    const auto solve = [this](const auto& box, const auto& from, const auto& desired, Answer<Case>& found) {
      const fpbm::Vector<N> goal = (desired - from).cwiseQuotient(unit_);
      qp_.g.template head<N>() = -goal;
      qp_.CE.col(N).noalias() = -qp_.CE.template leftCols<N>() * goal;
      qp_.ci.template head<N>() = (from - box.lower).cwiseQuotient(unit_);
      qp_.ci.template segment<N>(N + 1) = (box.upper - from).cwiseQuotient(unit_);
      const bool solved = qp_.solve();
      found = {from + unit_.cwiseProduct(qp_.x.template head<N>()), qp_.x(N)};
      return solved;
    };
    return solve_within(limits_, asked, desired_, answer, solve);
  }

 private:
  static constexpr int N = Case::kDof;
  static constexpr double kWeight = 1e4;

  Textbook<PinocchioKinematics, Case, Law::kFPBM> textbook_;
  fpbm::Limits<fpbm::Level::kAcceleration, N> limits_ = bench::limits<Case>(bounds);
  fpbm::Vector<N> unit_ = limits_.bounds().acceleration;
  fpbm::Vector<N> desired_;
  Program<N + 1, Case::kRows, 2 * (N + 1)> qp_;
};

template <typename Case, Bounds bounds>
using EiquadprogRt = Eiquadprog<Rt, Case, bounds>;
template <typename Case, Bounds bounds>
using EiquadprogFast = Eiquadprog<Fast, Case, bounds>;

[[maybe_unused]] const bool kAdded = add_limited_library<EiquadprogRt>() && add_limited_library<EiquadprogFast>();

}  // namespace
}  // namespace bench
