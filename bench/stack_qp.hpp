#pragma once

#include <eiquadprog/eiquadprog-fast.hpp>
#include <eiquadprog/eiquadprog-rt.hpp>

// Programs of both solvers of eiquadprog: min ½ xᵀH x + gᵀx, CE x + ce = 0, CI x + ci ≥ 0.
namespace bench::stack {

/// n variables, m equalities, c inequalities; sizes fixed at compile time.
template <int n, int m, int c>
struct Rt {
  static constexpr const char* kName = "eiquadprog-rt";

  Eigen::Matrix<double, n, n> H;
  Eigen::Matrix<double, n, 1> g;
  Eigen::Matrix<double, m, n> CE;
  Eigen::Matrix<double, m, 1> ce;
  Eigen::Matrix<double, c, n> CI = Eigen::Matrix<double, c, n>::Zero();
  Eigen::Matrix<double, c, 1> ci;
  Eigen::Matrix<double, n, 1> x;

  bool solve() { return solver.solve_quadprog(H, g, CE, ce, CI, ci, x) == eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL; }

  eiquadprog::solvers::RtEiquadprog<n, m, c> solver;
};

/// Sizes given at run time, in the compiled code of the library.
template <int n, int m, int c>
struct Fast {
  static constexpr const char* kName = "eiquadprog-fast";
  Fast() { solver.reset(n, m, c); }

  Eigen::MatrixXd H{n, n};
  Eigen::VectorXd g{n};
  Eigen::MatrixXd CE{m, n};
  Eigen::VectorXd ce{m};
  Eigen::MatrixXd CI = Eigen::MatrixXd::Zero(c, n);
  Eigen::VectorXd ci{c};
  Eigen::VectorXd x{n};

  bool solve() {
    return solver.solve_quadprog(H, g, CE, ce, CI, ci, x) == eiquadprog::solvers::EIQUADPROG_FAST_OPTIMAL;
  }

  eiquadprog::solvers::EiquadprogFast solver;
};

}  // namespace bench::stack
