#include <cstdio>

#include "report.hpp"

// The same motions on a PC, to compare with.
int main() {
  const auto print = [](const char* text) { std::fputs(text, stdout); };
  const auto nothing = [] { return std::uint32_t{0}; };
  fpbm::Status worst = firmware::report("panda", firmware::panda_motion(), print, nothing);
  worst = worse(worst, firmware::report("ur5e", firmware::ur5e_motion(), print, nothing));
  return failed(worst) ? 1 : 0;
}
