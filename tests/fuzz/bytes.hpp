#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include <fpbm/fpbm.hpp>

/// Reads a fuzzer's bytes as numbers, and zeros after the last byte.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  [[nodiscard]] bool empty() const { return left_ == 0; }

  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }

  /// From 0 to 1.
  double fraction() {
    const double high = byte();
    return (256.0 * high + byte()) / 65535.0;
  }

  double within(double lower, double upper) { return lower + fraction() * (upper - lower); }

  /// From lower to upper, evenly in the logarithm.
  double spread(double lower, double upper) { return lower * std::pow(upper / lower, fraction()); }

  /// Any double.
  double any() {
    using Double = std::numeric_limits<double>;
    const double sign = (byte() & 1) != 0 ? -1.0 : 1.0;
    switch (byte() % 8) {
      case 0: return Double::quiet_NaN();
      case 1: return sign * Double::infinity();
      case 2: return sign * Double::max();
      case 3: return sign * Double::denorm_min();
      case 4: return sign * Double::min();
      case 5: return sign * 0.0;
      case 6: return sign * spread(1e-300, 1e300);
      default: break;
    }
    std::uint8_t raw[sizeof(double)];
    for (std::uint8_t& part : raw) part = byte();
    double value;
    std::memcpy(&value, raw, sizeof value);
    return value;
  }

  /// True in of_256 of 256 cases.
  bool chance(int of_256) { return byte() >= 256 - of_256; }

  /// Mostly the number given, sometimes any double.
  double mostly(double ordinary) { return chance(8) ? any() : ordinary; }

  template <typename Derived>
  void fill(Eigen::MatrixBase<Derived>& out, double lower, double upper) {
    for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = mostly(within(lower, upper));
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};
