#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "motion.hpp"

/// Prints a motion, with the same text on the board and on a PC: the joint positions every second, in hexadecimal to
/// the last bit, then the worst status and the largest error.
namespace firmware {

/// A line of text that does not use the heap.
class Line {
 public:
  Line& operator<<(const char* text) {
    while (*text != '\0' && size_ + 1 < sizeof text_) text_[size_++] = *text++;
    text_[size_] = '\0';
    return *this;
  }

  Line& operator<<(std::uint32_t number) {
    char digits[11] = {};
    char* digit = digits + 10;
    do {
      *--digit = static_cast<char>('0' + number % 10);
      number /= 10;
    } while (number != 0);
    return *this << digit;
  }

  /// The bits of the number.
  Line& operator<<(float number) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    char digits[9] = {};
    for (int i = 0; i < 8; ++i) digits[i] = "0123456789abcdef"[bits >> (28 - 4 * i) & 15U];
    return *this << digits;
  }

  [[nodiscard]] const char* text() const { return text_; }

 private:
  char text_[160] = {};
  std::size_t size_ = 0;
};

/// print(text) writes a text. counter() returns the number of instructions, or 0.
template <typename Motion, typename Print, typename Counter>
fpbm::Status report(const char* name, Motion& motion, const Print& print, Counter&& counter) {
  fpbm::Status worst = fpbm::Status::kOk;
  float error = 0.0F;
  std::uint32_t most = 0;
  std::uint32_t all = 0;
  for (int i = 1; i <= kTicks; ++i) {
    const std::uint32_t before = counter();
    const auto tick = motion.tick();
    const std::uint32_t count = counter() - before;
    most = std::max(most, count);
    all += count;
    worst = worse(worst, tick.status);
    error = std::max(error, tick.error.template head<3>().norm());
    if (i % 1000 != 0) continue;
    Line line;
    line << name;
    for (int joint = 0; joint < Motion::kDof; ++joint) line << " " << motion.q()(joint);
    print((line << "\n").text());
  }
  Line line;
  line << name << " " << message(worst) << ", off by " << static_cast<std::uint32_t>(error * 1e6F) << " um at most\n";
  print(line.text());
  if (all > 0) {
    Line counted;
    counted << "# " << name << ": " << all / kTicks << " instructions a tick, " << most << " at most\n";
    print(counted.text());
  }
  return worst;
}

/// Reports all motions.
template <typename Print, typename Counter>
fpbm::Status report_all(Motions& motions, const Print& print, Counter&& counter) {
  fpbm::Status worst = report("panda", motions.panda, print, counter);
  worst = worse(worst, report("ur5e", motions.ur5e, print, counter));
  worst = worse(worst, report("panda_pressed", motions.panda_pressed, print, counter));
  worst = worse(worst, report("ur5e_pressed", motions.ur5e_pressed, print, counter));
  worst = worse(worst, report("panda_torques", motions.panda_torques, print, counter));
  return worse(worst, report("panda_torques_pressed", motions.panda_torques_pressed, print, counter));
}

}  // namespace firmware
