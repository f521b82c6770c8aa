#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>

namespace fpbm::test {

/// Number of trials. Under a sanitizer, which slows a program by a factor of about twenty: a tenth, but at least one.
[[nodiscard]] constexpr int trials(int all) {
#ifdef FPBM_FEW_TRIALS
  return std::max(all / 10, 1);
#else
  return all;
#endif
}

/// Number of trials of a slow test: few by default, all if FPBM_ALL_TRIALS is set, as by `make nightly`.
[[nodiscard]] inline int trials(int all, int few) {
  return std::getenv("FPBM_ALL_TRIALS") != nullptr ? trials(all) : std::min(trials(all), few);
}

/// Random test data, the same in every run and on every machine. All numbers are floats, so that every Scalar under
/// test starts from exactly the same data.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  [[nodiscard]] double uniform(double low, double high) {
    const double fraction = static_cast<double>(engine_()) / 4294967296.0;
    return static_cast<double>(static_cast<float>(low + (high - low) * fraction));
  }

  [[nodiscard]] Eigen::VectorXd uniform(Eigen::Index n, double low, double high) {
    Eigen::VectorXd values(n);
    for (double& value : values) value = uniform(low, high);
    return values;
  }

  [[nodiscard]] Eigen::MatrixXd uniform(Eigen::Index rows, Eigen::Index cols, double low, double high) {
    return uniform(rows * cols, low, high).reshaped(rows, cols);
  }

  /// Symmetric positive definite, with a condition number of order 10. Compiled once, because products of matrices of
  /// run-time size compile slowly.
  [[nodiscard]] Eigen::MatrixXd positive_definite(Eigen::Index n);

 private:
  std::mt19937 engine_;
};

}  // namespace fpbm::test
