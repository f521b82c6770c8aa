#pragma once

#include <Eigen/Core>

namespace fpbm::test {

/// Largest cᵀx subject to Ax ≤ b, where b ≥ 0 and the optimum is finite. Simplex method on a dense tableau with Bland's
/// rule, in long double: slow, but simple and reliable.
[[nodiscard]] double largest(const Eigen::VectorXd& c, const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// Largest s ≤ 1 for which a u in [lower, upper] with G u ≤ most satisfies J u = J rest + s J (desired − rest). rest
/// satisfies the bounds.
[[nodiscard]] double largest_scale(const Eigen::MatrixXd& J, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                   const Eigen::VectorXd& rest, const Eigen::VectorXd& desired,
                                   const Eigen::MatrixXd& G = {}, const Eigen::VectorXd& most = {});

}  // namespace fpbm::test
