#include "support/random.hpp"

namespace fpbm::test {

Eigen::MatrixXd Random::positive_definite(Eigen::Index n) {
  const Eigen::MatrixXd A = uniform(n, n, -1.0, 1.0);
  const Eigen::MatrixXd product = A * A.transpose() / static_cast<double>(n) + 0.2 * Eigen::MatrixXd::Identity(n, n);
  return product.cast<float>().cast<double>();
}

}  // namespace fpbm::test
