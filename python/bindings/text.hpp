#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

#include "fpbm/core/types.hpp"

/// Numbers as Python would write them, for repr.
namespace fpbm::bindings {

inline std::string text(double value) {
  char buffer[32];
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    if (std::strtod(buffer, nullptr) == value) break;
  }
  return buffer;
}

template <typename Derived>
std::string text(const Eigen::MatrixBase<Derived>& values) {
  std::string result = "[";
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    if (i > 0) result += ", ";
    if constexpr (Derived::ColsAtCompileTime == 1) {
      result += text(static_cast<double>(values(i)));
    } else {
      result += text(values.row(i).transpose().eval());
    }
  }
  return result + "]";
}

}  // namespace fpbm::bindings
