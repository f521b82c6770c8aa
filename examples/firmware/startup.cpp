#include <cstdint>
#include <cstdlib>

#include "semihosting.hpp"

// From reset to run(): stack pointer and vectors, floating-point unit, .data and .bss, constructors of global objects.
// A fault ends the program.

extern "C" {
extern std::uint32_t stack_bottom[];
extern std::uint32_t stack_top[];
extern const std::uint32_t data_stored[];
extern std::uint32_t data_begin[];
extern std::uint32_t data_end[];
extern std::uint32_t bss_begin[];
extern std::uint32_t bss_end[];
using Function = void (*)();
extern const Function constructors_begin[];
extern const Function constructors_end[];

int run();

[[noreturn]] void fault() {
  semihosting::write("fault\n");
  semihosting::exit(false);
}

/// Called by a constructor of fpbm that rejects its argument.
[[noreturn]] void abort() {
  semihosting::write("aborted\n");
  semihosting::exit(false);
}

[[noreturn]] void reset() {
  constexpr std::uintptr_t kCoprocessorAccess = 0xE000ED88;
  *reinterpret_cast<volatile std::uint32_t*>(kCoprocessorAccess) |= 0xFU << 20U;
  asm volatile("dsb\n isb" ::: "memory");

  const std::uint32_t* stored = data_stored;
  for (std::uint32_t* word = data_begin; word < data_end; ++word) *word = *stored++;
  for (std::uint32_t* word = bss_begin; word < bss_end; ++word) *word = 0;
  for (const Function* each = constructors_begin; each < constructors_end; ++each) (*each)();
  semihosting::exit(run() == 0);
}
}

namespace {

struct Vectors {
  std::uint32_t* stack;
  Function handlers[15];
};

// Reset, then the exceptions of the core. No interrupt is used.
[[gnu::section(".vectors"), gnu::used]] const Vectors kVectors = {
    stack_top,
    {reset, fault, fault, fault, fault, fault, nullptr, nullptr, nullptr, nullptr, fault, fault, nullptr, fault,
     fault}};

}  // namespace
