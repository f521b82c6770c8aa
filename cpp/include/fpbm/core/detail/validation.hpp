#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "fpbm/core/detail/argument.hpp"
#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Error for an argument that is out of range or has the wrong size.
class ParameterError : public std::invalid_argument {
 public:
  ParameterError(std::string name, int index, double value, const std::string& message)
      : std::invalid_argument(message), name_(std::move(name)), index_(index), value_(value) {}

  /// Name of the argument.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// Index of the wrong entry, or -1 if the argument as a whole is wrong.
  [[nodiscard]] int index() const noexcept { return index_; }
  /// Rejected value or rejected number of entries. NaN if the argument is not a number.
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  std::string name_;
  int index_;
  double value_;
};

}  // namespace fpbm

/// Checks of constructor arguments. A failed check throws a ParameterError, whose message has the name of the argument,
/// the index and the value. Without exceptions, a failed check prints the message of the error and aborts the program.
/// With EIGEN_NO_IO in addition, the program aborts without a message.
namespace fpbm::validation {

/// Whether error messages can be reported: by an exception or on a stream. Otherwise, no message is built, since
/// std::string would link the heap into firmware.
#if defined(__cpp_exceptions) || !defined(EIGEN_NO_IO)
inline constexpr bool kHasMessages = true;
#else
inline constexpr bool kHasMessages = false;
#endif

/// Throws a ParameterError with the given value and message.
[[noreturn, gnu::noinline, gnu::cold]] inline void reject_with([[maybe_unused]] const Argument& argument,
                                                               [[maybe_unused]] double value,
                                                               [[maybe_unused]] const std::string& message) {
#if defined(__cpp_exceptions)
  throw ParameterError(argument.name(), argument.index(), value, message);
#else
  std::fprintf(stderr, "fpbm: %s\n", message.c_str());
  std::abort();
#endif
}

/// Throws a ParameterError with the given value and the message "<argument><words>".
template <typename Scalar, typename... Words>
[[noreturn, gnu::noinline, gnu::cold]] void reject_value(const Argument& argument, Scalar value, Words... words) {
  if constexpr (kHasMessages) {
    std::string message = argument.text();
    (append_text(message, words), ...);
    reject_with(argument, static_cast<double>(value), message);
  } else {
    std::abort();
  }
}

/// reject_value() for an argument that is not a number.
template <typename... Words>
[[noreturn]] void reject(const Argument& argument, Words... words) {
  reject_value(argument, std::numeric_limits<float>::quiet_NaN(), words...);
}

/// Throws a ParameterError with the message "<argument> = <value>: must be <demand>".
template <typename Scalar, typename... Demand>
[[noreturn]] void fail(const Argument& argument, Scalar value, Demand... demand) {
  reject_value(argument, value, " = ", value, ": must be ", demand...);
}

/// Calls demand(number) for a single number, or for the number in each lane.
template <typename Scalar, typename Demand>
void each_number(const Scalar& value, Demand&& demand) {
  if constexpr (kInLanes<Scalar>) {
    for (std::size_t lane = 0; lane < value.size(); ++lane) demand(value[lane]);
  } else {
    demand(value);
  }
}

template <typename Scalar, typename = Mask<Scalar>>
void require_positive(const Argument& argument, const Scalar& values) {
  each_number(values, [&](auto value) {
    if (!(value > 0) || !std::isfinite(value)) fail(argument, value, "positive and finite");
  });
}

template <typename Scalar, typename = Mask<Scalar>>
void require_non_negative(const Argument& argument, const Scalar& values) {
  each_number(values, [&](auto value) {
    if (!(value >= 0) || !std::isfinite(value)) fail(argument, value, "finite and not negative");
  });
}

template <typename Scalar, typename = Mask<Scalar>>
void require_finite(const Argument& argument, const Scalar& values) {
  each_number(values, [&](auto value) {
    if (!std::isfinite(value)) fail(argument, value, "finite");
  });
}

/// Fraction: requires 0 ≤ value ≤ 1.
template <typename Scalar, typename = Mask<Scalar>>
void require_fraction(const Argument& argument, const Scalar& values) {
  each_number(values, [&](auto value) {
    if (!(value >= 0 && value <= 1)) fail(argument, value, "in [0, 1]");
  });
}

template <typename Derived>
void require_positive(const Argument& argument, const Eigen::MatrixBase<Derived>& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) require_positive(element(argument, i), values(i));
}

template <typename Derived>
void require_finite(const Argument& argument, const Eigen::MatrixBase<Derived>& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) require_finite(element(argument, i), values(i));
}

inline void require_size(const Argument& argument, Eigen::Index size, Eigen::Index expected) {
  if (size != expected) {
    reject_value(argument, size, " has ", size, " entries: must have ", expected, ", one per joint");
  }
}

/// Joint vector: requires one finite entry per joint.
template <typename Derived>
void require_joint_vector(const Argument& argument, const Eigen::MatrixBase<Derived>& values, Eigen::Index dof) {
  require_size(argument, values.size(), dof);
  require_finite(argument, values);
}

/// Number of joints: requires at least `least`, and at most kMaxDof.
inline void require_dof(const Argument& argument, Eigen::Index dof, int least) {
  if (dof < least || dof > kMaxDof) {
    reject_value(argument, dof, " has ", dof, " entries: must have ", least, " to ", kMaxDof, ", one per joint");
  }
}

}  // namespace fpbm::validation
