#pragma once

#include <array>
#include <cstdint>

// Stand-in for the header of libfranka with this name: only the parts that the examples use.
namespace franka {

struct RobotState {
  std::array<double, 7> q{0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785};
  std::array<double, 7> dq{};
  double m_total = 0.73;  // The hand.
  std::array<double, 3> F_x_Ctotal{-0.01, 0.0, 0.03};
  std::array<double, 9> I_total{0.001, 0.0, 0.0, 0.0, 0.0025, 0.0, 0.0, 0.0, 0.0017};
};

class Duration {
 public:
  explicit Duration(std::uint64_t milliseconds) noexcept : milliseconds_(milliseconds) {}
  [[nodiscard]] double toSec() const noexcept { return 1e-3 * static_cast<double>(milliseconds_); }
  [[nodiscard]] std::uint64_t toMSec() const noexcept { return milliseconds_; }

 private:
  std::uint64_t milliseconds_;
};

}  // namespace franka
