#pragma once

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "fpbm/core/mask.hpp"
#include "fpbm/core/types.hpp"

/// What constructors demand of their arguments. Each failure names the argument, the index and the value.
namespace fpbm::validation {

[[noreturn]] inline void fail(const std::string& argument, double value, const char* demand) {
  char number[32];
  std::snprintf(number, sizeof number, "%.9g", value);
  throw std::invalid_argument(argument + " = " + number + ": must be " + demand);
}

inline std::string element(const char* argument, Eigen::Index i) {
  return std::string(argument) + "[" + std::to_string(i) + "]";
}

inline std::string element(const char* argument, Eigen::Index i, Eigen::Index j) {
  return std::string(argument) + "[" + std::to_string(i) + ", " + std::to_string(j) + "]";
}

/// demand(number) for the number, or each of the numbers, that a Scalar is.
template <typename Scalar, typename Demand>
void each_number(const Scalar& value, Demand&& demand) {
  if constexpr (kInLanes<Scalar>) {
    for (std::size_t lane = 0; lane < value.size(); ++lane) demand(static_cast<double>(value[lane]));
  } else {
    demand(static_cast<double>(value));
  }
}

template <typename Scalar, typename = Mask<Scalar>>
void require_positive(const std::string& argument, const Scalar& values) {
  each_number(values, [&](double value) {
    if (!(value > 0.0) || !std::isfinite(value)) fail(argument, value, "positive and finite");
  });
}

template <typename Scalar, typename = Mask<Scalar>>
void require_non_negative(const std::string& argument, const Scalar& values) {
  each_number(values, [&](double value) {
    if (!(value >= 0.0) || !std::isfinite(value)) fail(argument, value, "finite and not negative");
  });
}

template <typename Scalar, typename = Mask<Scalar>>
void require_finite(const std::string& argument, const Scalar& values) {
  each_number(values, [&](double value) {
    if (!std::isfinite(value)) fail(argument, value, "finite");
  });
}

/// Balance between two schemes: 0 ≤ value ≤ 1.
template <typename Scalar, typename = Mask<Scalar>>
void require_fraction(const std::string& argument, const Scalar& values) {
  each_number(values, [&](double value) {
    if (!(value >= 0.0 && value <= 1.0)) fail(argument, value, "in [0, 1]");
  });
}

template <typename Derived>
void require_positive(const char* argument, const Eigen::MatrixBase<Derived>& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) require_positive(element(argument, i), values(i));
}

template <typename Derived>
void require_finite(const char* argument, const Eigen::MatrixBase<Derived>& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) require_finite(element(argument, i), values(i));
}

inline void require_size(const char* argument, Eigen::Index size, Eigen::Index expected) {
  if (size != expected) {
    throw std::invalid_argument(std::string(argument) + " has " + std::to_string(size) + " entries: must have " +
                                std::to_string(expected) + ", one per joint");
  }
}

/// A joint vector: one finite entry per joint.
template <typename Derived>
void require_joint_vector(const char* argument, const Eigen::MatrixBase<Derived>& values, Eigen::Index dof) {
  require_size(argument, values.size(), dof);
  require_finite(argument, values);
}

/// Number of joints: at least one for each task row, at most kMaxDof.
inline void require_dof(const char* argument, Eigen::Index dof, int task_rows) {
  if (dof < task_rows || dof > kMaxDof) {
    throw std::invalid_argument(std::string(argument) + " has " + std::to_string(dof) + " entries: must have " +
                                std::to_string(task_rows) + " to " + std::to_string(kMaxDof) +
                                ", one per joint, and no fewer than the task has rows");
  }
}

}  // namespace fpbm::validation
