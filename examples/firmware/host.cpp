#include <cstdio>

#include "report.hpp"

// The motions of the firmware on a PC, for comparison.
int main() {
  const auto print = [](const char* text) { std::fputs(text, stdout); };
  const auto nothing = [] { return std::uint32_t{0}; };
  firmware::Motions motions;
  return failed(firmware::report_all(motions, print, nothing)) ? 1 : 0;
}
