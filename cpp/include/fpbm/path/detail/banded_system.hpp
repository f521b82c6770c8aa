#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace fpbm {

/// Linear equations with a symmetric positive definite matrix that has two bands beside its diagonal.
struct BandedSystem {
  std::vector<std::array<double, 3>> matrix;  ///< Row i: the entries (i, i), (i, i + 1) and (i, i + 2).
  std::vector<double> right;                  ///< The right side; after solve(), the solution x.

  [[nodiscard]] std::size_t size() const noexcept { return right.size(); }

  void reset(std::size_t n) {
    matrix.assign(n, {});
    right.assign(n, 0.0);
  }

  /// Requires x[e] + x[b] = sum of the solution, and eliminates x[e]: in the solution, x[e] is zero instead. e is the
  /// first or the last index, b and c are the next two indices.
  void require_sum(std::size_t e, std::size_t b, std::size_t c, double sum) {
    const auto entry = [this](std::size_t i, std::size_t j) -> double& {
      return i < j ? matrix[i][j - i] : matrix[j][i - j];
    };
    right[b] += (entry(e, e) - entry(e, b)) * sum - right[e];
    right[c] -= entry(e, c) * sum;
    entry(b, b) += entry(e, e) - 2.0 * entry(e, b);
    entry(b, c) -= entry(e, c);
    entry(e, e) = 1.0;
    entry(e, b) = entry(e, c) = right[e] = 0.0;
  }

  /// Solves by LDLᵀ, in place. Returns the product of the right side and the solution.
  double solve() {
    const std::size_t n = right.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 1; k < 3 && i + k < n; ++k) {
        const double factor = matrix[i][k] / matrix[i][0];
        for (std::size_t c = k; c < 3; ++c) matrix[i + k][c - k] -= factor * matrix[i][c];
        right[i + k] -= factor * right[i];
      }
    }
    double product = 0.0;
    for (std::size_t i = n; i-- > 0;) {
      product += right[i] * right[i] / matrix[i][0];
      for (std::size_t k = 1; k < 3 && i + k < n; ++k) right[i] -= matrix[i][k] * right[i + k];
      right[i] /= matrix[i][0];
    }
    return product;
  }
};

}  // namespace fpbm
