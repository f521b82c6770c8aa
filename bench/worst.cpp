#include "worst.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#ifdef FPBM_COUNTS
#include <valgrind/callgrind.h>
#endif

// The motions of worst_motions.txt. Times: the duration of each tick is the smallest of several runs, so that
// interruptions by the machine do not count. Under callgrind: a dump for each tick near the longest, for worst.py.
//
//     bench_worst RUNS [FILE]
namespace bench {
namespace {

constexpr int kWindow = 8;  ///< Ticks counted before and after the longest.

/// The target moves slowly, at 1.5 cm/s and 0.015 rad/s along and about each axis.
template <typename Case>
Numbers free_motion() {
  Numbers numbers(WorstMotion<Case>::kNumbers);
  for (int i = 6; i < 12; ++i) numbers[Case::kDof + static_cast<std::size_t>(i)] = 0.01;
  numbers[Case::kDof + 12] = 1.0;
  return numbers;
}

#ifdef FPBM_COUNTS
template <typename Job>
void count(const std::string& row, const Job& job) {
  CALLGRIND_TOGGLE_COLLECT;
  job();
  CALLGRIND_TOGGLE_COLLECT;
  CALLGRIND_DUMP_STATS_AT(row.c_str());
}

template <typename Case>
void count_ticks(const Found& found) {
  WorstMotion<Case> free(free_motion<Case>());
  for (int k = 0; k < kLongest && free.next(); ++k) {
    k + kWindow < kLongest ? free.tick()
                           : count(
                                 "free/" + Case::name(), [&] { free.tick(); });
  }
  WorstMotion<Case> motion(found.numbers);
  for (int k = 0; motion.next() && k <= found.tick + kWindow; ++k) {
    k < found.tick - kWindow ? motion.tick()
                             : count(
                                   "worst/" + Case::name(), [&] { motion.tick(); });
  }
}
#endif

/// Smallest duration of each tick of a motion [ns].
template <typename Case>
std::vector<double> times(const Numbers& numbers, int runs) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> least;
  for (int run = 0; run < runs; ++run) {
    WorstMotion<Case> motion(numbers);
    for (std::size_t k = 0; motion.next(); ++k) {
      const auto begin = Clock::now();
      motion.tick();
      const double time = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
      if (run == 0) least.push_back(time);
      least[k] = std::min(least[k], time);
    }
  }
  return least;
}

template <typename Case>
void time_ticks(const Found& found, int runs) {
  const double free = times<Case>(free_motion<Case>(), runs)[kLongest - 1];
  auto sorted = times<Case>(found.numbers, runs);
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  std::printf("%-20s %8.2f %8.2f %8.2f %8.2f %8.2f\n", Case::name().c_str(), free / 1e3, quantile(0.5) / 1e3,
              quantile(0.999) / 1e3, sorted.back() / 1e3, sorted.back() / free);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s RUNS [FILE]\n", argv[0]);
    return EXIT_FAILURE;
  }
  const int runs = std::atoi(argv[1]);
  const std::string file = argc > 2 ? argv[2] : WORST_MOTIONS;
#ifdef FPBM_COUNTS
  if (RUNNING_ON_VALGRIND != 0) {
    for (int k = 0; k < 2 * bench::kWindow; ++k) bench::count("nothing", [] {});
    bench::for_each_worst([&](auto one) { bench::count_ticks<decltype(one)>(bench::found_in(file, one.name())); });
    return EXIT_SUCCESS;
  }
#endif
  std::printf("%-20s %8s %8s %8s %8s %8s\n", "a tick [us]", "free", "median", "p99.9", "worst", "of free");
  bench::for_each_worst([&](auto one) { bench::time_ticks<decltype(one)>(bench::found_in(file, one.name()), runs); });
  return EXIT_SUCCESS;
}
