#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "fpbm/core/detail/validation.hpp"

namespace fpbm {

/// Error for a start posture in which two shapes are closer than the margin. what() names the remedies in C++.
class TooClose : public ParameterError {
 public:
  TooClose(std::pair<std::string, std::string> names, double distance, double margin)
      : ParameterError("q0", -1, distance,
                       text(names, distance, margin, "allowed={{\"" + names.first + "\", \"" + names.second + "\"}}")),
        names_(std::move(names)),
        margin_(margin) {}

  [[nodiscard]] const std::pair<std::string, std::string>& names() const noexcept { return names_; }
  [[nodiscard]] double margin() const noexcept { return margin_; }

  /// The message, which proposes `remedy` in the syntax of the caller's language. If the shapes do not overlap, the
  /// message also proposes a smaller margin.
  [[nodiscard]] static std::string text(const std::pair<std::string, std::string>& names, double distance,
                                        double margin, const std::string& remedy) {
    const double smaller = std::floor(distance * kDigits) / kDigits;
    const std::string less = smaller >= 0.0 ? "give margin=" + number("%.4g", smaller) + " or " : "give ";
    const std::string are = distance >= 0.0 ? " are " + number("%.4f", distance) + " m apart, closer than margin="
                                            : " overlap by " + number("%.4f", -distance) + " m, with margin=";
    return "q0: " + names.first + " and " + names.second + are + number("%.4g", margin) + "; " + less + remedy;
  }

 private:
  static constexpr double kDigits = 1e4;  ///< The proposed margin is a multiple of 0.1 mm.

  [[nodiscard]] static std::string number(const char* format, double value) {
    char written[32];
    std::snprintf(written, sizeof written, format, value);
    return written;
  }

  std::pair<std::string, std::string> names_;
  double margin_;
};

/// Throws TooClose. Without exceptions, prints the message and aborts the program.
[[noreturn]] inline void reject_close(const std::pair<std::string, std::string>& names, double distance,
                                      double margin) {
#if defined(__cpp_exceptions)
  throw TooClose(names, distance, margin);
#else
  const TooClose error(names, distance, margin);
#if !defined(EIGEN_NO_IO)
  std::fprintf(stderr, "fpbm: %s\n", error.what());
#endif
  std::abort();
#endif
}

}  // namespace fpbm
