#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "worst.hpp"

// Searches for the motions whose ticks execute the most basic blocks, which the compiler counts here
// (-fsanitize-coverage=trace-pc). The search climbs from random motions and from the motions of the file.
//
//     bench_search_worst FILE SECONDS [CASE]
//
// Prints the motion of each case as a line of FILE.
namespace bench {

extern std::uint64_t executed_blocks;  // blocks.cpp

namespace {

/// Largest number of blocks of a tick, and the number of the tick.
template <typename Case>
std::uint64_t cost(const Numbers& numbers, int* at = nullptr) {
  std::uint64_t most = 0;
  try {
    WorstMotion<Case> motion(numbers);
    for (int tick = 0; motion.next(); ++tick) {
      const std::uint64_t before = executed_blocks;
      motion.tick();
      if (executed_blocks - before <= most) continue;
      most = executed_blocks - before;
      if (at != nullptr) *at = tick;
    }
  } catch (const std::invalid_argument&) {  // The start is closer to a shape than the margin.
  }
  return most;
}

template <typename Case>
void search(const std::string& file, double seconds) {
  using Clock = std::chrono::steady_clock;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::normal_distribution<double> near(0.0, 0.1);
  Numbers best = found_in(file, Case::name()).numbers;
  std::uint64_t highest = best.empty() ? 0 : cost<Case>(best);
  const std::uint64_t known = highest;
  const auto begin = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  long motions = 0;
  for (int climb = 0; passed() < seconds; ++climb) {
    Numbers numbers(WorstMotion<Case>::kNumbers);
    std::uint64_t reached = 0;
    if (climb % 4 == 3) {  // Every fourth climb continues from the best motion.
      numbers = best;
      reached = highest;
    }
    for (int i = 0; i < 30 && climb % 4 != 3; ++i) {
      Numbers start(numbers.size());
      for (double& number : start) number = any(random);
      const std::uint64_t found = cost<Case>(start);
      if (found >= reached) {
        reached = found;
        numbers = start;
      }
    }
    for (int idle = 0; idle < 400 && passed() < seconds; ++idle, ++motions) {
      Numbers changed = numbers;
      const auto changes = 1 + random() % 6;
      for (std::uint64_t k = 0; k < changes; ++k) {
        double& number = changed[random() % changed.size()];
        number = random() % 2 == 0 ? any(random) : std::clamp(number + near(random), -1.0, 1.0);
      }
      const std::uint64_t found = cost<Case>(changed);
      if (found < reached) continue;
      if (found > reached) idle = 0;
      reached = found;
      numbers = changed;
    }
    if (reached > highest) {
      highest = reached;
      best = numbers;
    }
  }
  int tick = 0;
  (void)cost<Case>(best, &tick);
  std::printf("%s %d", Case::name().c_str(), tick);
  for (const double number : best) std::printf(" %.17g", number);
  std::printf("\n");
  std::fprintf(stderr, "%s: %llu blocks in a tick, %llu before, %ld motions\n", Case::name().c_str(),
               static_cast<unsigned long long>(highest), static_cast<unsigned long long>(known), motions);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s FILE SECONDS [CASE]\n", argv[0]);
    return EXIT_FAILURE;
  }
  bench::for_each_worst([&](auto one) {
    if (argc == 3 || one.name() == argv[3]) bench::search<decltype(one)>(argv[1], std::atof(argv[2]));
  });
}
