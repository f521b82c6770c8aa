#include <cstdint>

#include "report.hpp"
#include "semihosting.hpp"

// A Panda and a UR5e on a Cortex-M7 draw circles. The program prints joint positions, the number of instructions per
// tick, and the size of the stack by semihosting.

extern "C" {
extern std::uint32_t stack_bottom[];
extern std::uint32_t stack_top[];

/// Called by startup.cpp.
int run();
}

namespace {

/// Counts instructions by the SysTick timer of the core, at 25 MHz. In qemu -icount shift=0, an instruction is 1 ns.
class Counter {
 public:
  Counter() {
    at(kReload) = kMost;
    at(kCurrent) = 0;
    at(kControl) = 0b101;  // Enabled, at the clock of the core.
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
  static constexpr std::uint32_t kInstructions = 40;  // Per count.

  static volatile std::uint32_t& at(std::uintptr_t place) { return *reinterpret_cast<volatile std::uint32_t*>(place); }

  std::uint32_t last_ = 0;
  std::uint32_t count_ = 0;
};

constexpr std::uint32_t kUnused = 0xA5A5A5A5;

/// Marks the unused stack below the frame of this function, to measure the used stack.
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
  static firmware::Motions motions;  // As in a controller: the stack contains only the ticks.
  const std::uint32_t construction = used_stack();
  mark_stack();
  Counter counter;
  const fpbm::Status worst = firmware::report_all(motions, semihosting::write, counter);
  firmware::Line line;
  line << "# stack: " << used_stack() << " bytes, at construction " << construction << " bytes\n";
  semihosting::write(line.text());
  return failed(worst) ? 1 : 0;
}
