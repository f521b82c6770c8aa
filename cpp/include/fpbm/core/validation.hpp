#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "fpbm/core/mask.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// An argument that is out of range or of the wrong size.
class ParameterError : public std::invalid_argument {
 public:
  ParameterError(std::string name, int index, double value, const std::string& message)
      : std::invalid_argument(message), name_(std::move(name)), index_(index), value_(value) {}

  /// The argument.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// Its entry, or -1 where the argument as a whole is wrong.
  [[nodiscard]] int index() const noexcept { return index_; }
  /// What it is: a number, a number of entries, or NaN where it is no number.
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  std::string name_;
  int index_;
  double value_;
};

}  // namespace fpbm

/// What constructors require of their arguments. Each failure is a ParameterError, whose message names the argument,
/// the index and the value; without exceptions, the end of the program with that message.
namespace fpbm::validation {

/// An argument, or an entry of it, and how messages name it: text begins with name.
struct Argument {
  Argument(const char* argument) : Argument(std::string(argument)) {}
  Argument(const std::string& argument) : name(argument), text(argument) {}
  Argument(std::string argument, Eigen::Index i, std::string label)
      : name(std::move(argument)), index(static_cast<int>(i)), text(std::move(label)) {}

  std::string name;
  int index = -1;
  std::string text;

  /// A part of it: element("joints", 2) + ".axis".
  [[nodiscard]] friend Argument operator+(Argument argument, const std::string& part) {
    if (argument.index < 0) argument.name += part;
    argument.text += part;
    return argument;
  }
};

inline Argument element(const char* argument, Eigen::Index i) {
  return {argument, i, std::string(argument) + "[" + std::to_string(i) + "]"};
}

/// An entry of a matrix, whose index is its row.
inline Argument element(const char* argument, Eigen::Index i, Eigen::Index j) {
  return {argument, i, std::string(argument) + "[" + std::to_string(i) + ", " + std::to_string(j) + "]"};
}

/// Throws a ParameterError that says "<argument><what>". Where the compiler was told to do without exceptions, says so
/// on the standard error output and aborts.
[[noreturn]] inline void reject(const Argument& argument, const std::string& what,
                                [[maybe_unused]] double value = std::numeric_limits<double>::quiet_NaN()) {
#if defined(__cpp_exceptions)
  throw ParameterError(argument.name, argument.index, value, argument.text + what);
#else
  std::fprintf(stderr, "fpbm: %s\n", (argument.text + what).c_str());
  std::abort();
#endif
}

/// Throws a ParameterError that says "<argument> = <value>: must be <demand>".
[[noreturn]] inline void fail(const Argument& argument, double value, const char* demand) {
  char number[32];
  std::snprintf(number, sizeof number, "%.9g", value);
  reject(argument, std::string(" = ") + number + ": must be " + demand, value);
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
void require_positive(const Argument& argument, const Scalar& values) {
  each_number(values, [&](double value) {
    if (!(value > 0.0) || !std::isfinite(value)) fail(argument, value, "positive and finite");
  });
}

template <typename Scalar, typename = Mask<Scalar>>
void require_non_negative(const Argument& argument, const Scalar& values) {
  each_number(values, [&](double value) {
    if (!(value >= 0.0) || !std::isfinite(value)) fail(argument, value, "finite and not negative");
  });
}

template <typename Scalar, typename = Mask<Scalar>>
void require_finite(const Argument& argument, const Scalar& values) {
  each_number(values, [&](double value) {
    if (!std::isfinite(value)) fail(argument, value, "finite");
  });
}

/// Balance between two schemes: 0 ≤ value ≤ 1.
template <typename Scalar, typename = Mask<Scalar>>
void require_fraction(const Argument& argument, const Scalar& values) {
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
    reject(argument,
           " has " + std::to_string(size) + " entries: must have " + std::to_string(expected) + ", one per joint",
           static_cast<double>(size));
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
    reject(argument,
           " has " + std::to_string(dof) + " entries: must have " + std::to_string(task_rows) + " to " +
               std::to_string(kMaxDof) + ", one per joint, and no fewer than the task has rows",
           static_cast<double>(dof));
  }
}

}  // namespace fpbm::validation
