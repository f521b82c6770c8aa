#include <cstdint>

#include "report.hpp"
#include "semihosting.hpp"

// A Panda and a UR5e on a Cortex-M7: each draws a circle, and says over semihosting where its joints are, how many
// instructions a tick takes, and how deep the stack gets.

extern "C" {
extern std::uint32_t stack_bottom[];
extern std::uint32_t stack_top[];

/// Called by startup.cpp.
int run();
}

namespace {

/// Instructions by the core's SysTick timer, which counts down at 25 MHz; qemu -icount shift=0 takes 1 ns for each.
class Counter {
 public:
  Counter() {
    at(kReload) = kMost;
    at(kCurrent) = 0;
    at(kControl) = 0b101;  // On, at the core's clock.
  }

  std::uint32_t operator()() {
    const std::uint32_t now = at(kCurrent);
    count_ += (last_ - now) & kMost;
    last_ = now;
    return kInstructions * count_;
  }

 private:
  static constexpr std::uintptr_t kControl = 0xE000E010;
  static constexpr std::uintptr_t kReload = 0xE000E014;
  static constexpr std::uintptr_t kCurrent = 0xE000E018;
  static constexpr std::uint32_t kMost = 0xFFFFFF;
  static constexpr std::uint32_t kInstructions = 40;  // A count.

  static volatile std::uint32_t& at(std::uintptr_t place) { return *reinterpret_cast<volatile std::uint32_t*>(place); }

  std::uint32_t last_ = 0;
  std::uint32_t count_ = 0;
};

constexpr std::uint32_t kUnused = 0xA5A5A5A5;

/// Marks what lies below this function's frame, so that what has been used can be told.
void mark_stack() {
  auto* frame = static_cast<std::uint32_t*>(__builtin_frame_address(0));
  for (std::uint32_t* word = stack_bottom; word < frame - 64; ++word) *word = kUnused;
}

std::uint32_t used_stack() {
  const std::uint32_t* word = stack_bottom;
  while (*word == kUnused) ++word;
  return static_cast<std::uint32_t>(stack_top - word) * sizeof(std::uint32_t);
}

}  // namespace

int run() {
  mark_stack();
  Counter counter;
  const fpbm::Status worst = firmware::report_all(semihosting::write, counter);
  firmware::Line line;
  semihosting::write((line << "# stack: " << used_stack() << " bytes\n").text());
  return failed(worst) ? 1 : 0;
}
