#include "support/linear_program.hpp"

#include <Eigen/LU>
#include <limits>

namespace fpbm::test {

namespace {
using Tableau = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
constexpr long double kZero = 1e-13L;
}  // namespace

double largest(const Eigen::VectorXd& c, const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  // x is free: each column has a negative copy. Row 0 contains the reduced costs, column 0 the values.
  const Eigen::Index rows = A.rows();
  const Eigen::Index free = A.cols();
  const Eigen::Index columns = 2 * free + rows;
  Tableau T = Tableau::Zero(rows + 1, columns + 1);
  T.block(0, 1, 1, free) = -c.transpose().cast<long double>();
  T.block(0, 1 + free, 1, free) = c.transpose().cast<long double>();
  T.block(1, 0, rows, 1) = b.cast<long double>();
  T.block(1, 1, rows, free) = A.cast<long double>();
  T.block(1, 1 + free, rows, free) = -A.cast<long double>();
  // Scales rows of joints that hardly move.
  for (Eigen::Index i = 1; i <= rows; ++i) {
    const long double size = T.row(i).segment(1, free).cwiseAbs().maxCoeff();
    if (size > 0.0L) T.row(i) /= size;
  }
  T.block(1, 1 + 2 * free, rows, rows).setIdentity();
  Eigen::VectorXi basic(rows);
  for (Eigen::Index i = 0; i < rows; ++i) basic(i) = static_cast<int>(1 + 2 * free + i);
  for (int pivots = 0; pivots < 10000; ++pivots) {
    Eigen::Index enters = 1;
    while (enters <= columns && T(0, enters) >= -kZero) ++enters;
    if (enters > columns) break;
    Eigen::Index leaves = 0;
    long double least = std::numeric_limits<long double>::infinity();
    for (Eigen::Index i = 1; i <= rows; ++i) {
      if (T(i, enters) <= kZero) continue;
      const long double ratio = T(i, 0) / T(i, enters);
      if (ratio < least || (ratio == least && basic(i - 1) < basic(leaves - 1))) {
        least = ratio;
        leaves = i;
      }
    }
    if (leaves == 0) return std::numeric_limits<double>::infinity();
    T.row(leaves) /= T(leaves, enters);
    for (Eigen::Index i = 0; i <= rows; ++i) {
      if (i != leaves) T.row(i) -= T(i, enters) * T.row(leaves).eval();
    }
    basic(leaves - 1) = static_cast<int>(enters);
  }
  return static_cast<double>(T(0, 0));
}

double largest_scale(const Eigen::MatrixXd& J, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                     const Eigen::VectorXd& rest, const Eigen::VectorXd& desired, const Eigen::MatrixXd& G,
                     const Eigen::VectorXd& most) {
  const Eigen::Index n = J.cols();
  Eigen::FullPivLU<Eigen::MatrixXd> lu(J);
  lu.setThreshold(1e-12);
  const Eigen::Index free = lu.dimensionOfKernel();  // If the kernel is empty, Eigen's kernel() has a zero column.
  Eigen::MatrixXd motion(n, free + 1);
  motion.col(0) = desired - rest;
  if (free > 0) motion.rightCols(free) = lu.kernel();
  const Eigen::Index rows = most.size();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n + 1 + rows, free + 1);
  Eigen::VectorXd b(2 * n + 1 + rows);
  A.topRows(n) = motion;
  A.middleRows(n, n) = -motion;
  A(2 * n, 0) = 1.0;
  if (rows > 0) A.bottomRows(rows) = G * motion;
  b.head(2 * n + 1) << upper - rest, rest - lower, 1.0;
  if (rows > 0) b.tail(rows) = most - G * rest;
  return largest(Eigen::VectorXd::Unit(free + 1, 0), A, b);
}

}  // namespace fpbm::test
