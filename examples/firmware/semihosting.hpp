#pragma once

#include <cstdint>

/// Services of a debugger or qemu, which the board calls by a breakpoint (Arm's Semihosting specification).
namespace semihosting {

inline std::uint32_t call(std::uint32_t operation, const void* argument) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

inline void write(const char* text) {
  call(0x04, text);  // SYS_WRITE0
}

/// Ends qemu with success or failure.
[[noreturn]] inline void exit(bool success) {
  constexpr std::uint32_t kApplicationExit = 0x20026;
  constexpr std::uint32_t kRunTimeError = 0x20023;
  call(0x18, reinterpret_cast<const void*>(success ? kApplicationExit : kRunTimeError));  // SYS_EXIT
  for (;;) {
  }
}

}  // namespace semihosting
