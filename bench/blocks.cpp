#include <cstdint>

// Compiled without coverage, which search_worst.cpp is compiled with.
namespace bench {
std::uint64_t executed_blocks = 0;
}

extern "C" void __sanitizer_cov_trace_pc() {
  ++bench::executed_blocks;
}
