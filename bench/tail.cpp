#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <sys/resource.h>

#if defined(__x86_64__) && defined(__linux__)
#include <link.h>
#include <x86intrin.h>
#define FPBM_HAS_CLFLUSH
#endif

#include "jobs.hpp"

// Durations of single calls, measured until the result of the call is available. Prints percentiles of many calls, with
// warm and with cold caches, as JSON. Row "timer" is the duration without a job. This duration is not subtracted from
// the other rows. Alternately with a warm job, an empty job of the same duration is timed ("empty_…"): the machine
// causes the tail of the empty job.
namespace bench {
namespace {

#ifdef FPBM_HAS_CLFLUSH
/// In ticks of the time stamp counter. Fences keep the timed code between the two reads, and wait for its results.
struct Clock {
  static std::uint64_t start() noexcept {
    _mm_lfence();
    const std::uint64_t now = __rdtsc();
    _mm_lfence();
    return now;
  }
  static std::uint64_t stop() noexcept {
    unsigned processor;
    const std::uint64_t now = __rdtscp(&processor);
    _mm_lfence();
    return now;
  }
};
#else
struct Clock {
  static std::uint64_t start() noexcept {
    return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  }
  static std::uint64_t stop() noexcept { return start(); }
};
#endif

/// Nanoseconds per tick of Clock.
double tick_length() {
  using std::chrono::steady_clock;
  const auto begin = steady_clock::now();
  const std::uint64_t first = Clock::start();
  while (steady_clock::now() - begin < std::chrono::milliseconds(100)) continue;
  const std::uint64_t last = Clock::stop();
  const std::chrono::duration<double, std::nano> passed = steady_clock::now() - begin;
  return passed.count() / static_cast<double>(last - first);
}

/// Counts of durations. Most durations are similar. Therefore, the histogram uses a small part of the caches.
class Histogram {
 public:
  void add(std::uint64_t ticks) {
    if (ticks < counts_.size()) {
      ++counts_[ticks];
    } else {
      ++long_[ticks];
    }
    ++total_;
  }

  /// The smallest duration that at most the fraction 1 − `fraction` of all durations exceeds.
  [[nodiscard]] std::uint64_t quantile(double fraction) const {
    auto left = static_cast<std::uint64_t>(fraction * static_cast<double>(total_ - 1));
    for (std::size_t ticks = 0; ticks < counts_.size(); ++ticks) {
      if (left < counts_[ticks]) return ticks;
      left -= counts_[ticks];
    }
    for (const auto& [ticks, count] : long_) {
      if (left < count) return ticks;
      left -= count;
    }
    return 0;
  }

 private:
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(1 << 16);
  std::map<std::uint64_t, std::uint64_t> long_;
  std::uint64_t total_ = 0;
};

#ifdef FPBM_HAS_CLFLUSH
void flush(const void* begin, std::size_t size) noexcept {
  constexpr std::uintptr_t kLine = 64;
  const auto first = reinterpret_cast<std::uintptr_t>(begin);
  for (std::uintptr_t line = first & ~(kLine - 1); line < first + size; line += kLine) {
    _mm_clflush(reinterpret_cast<const void*>(line));
  }
}

/// Evicts from all caches: the program with its constants and variables, the stack of the next call, and the job. The
/// libraries of the system are not evicted.
template <typename Job>
void evict(const Job& job) noexcept {
  const auto flush_program = [](dl_phdr_info* object, std::size_t, void*) {
    for (int i = 0; i < object->dlpi_phnum; ++i) {
      const auto& segment = object->dlpi_phdr[i];
      if (segment.p_type != PT_LOAD) continue;
      flush(reinterpret_cast<const void*>(object->dlpi_addr + segment.p_vaddr), segment.p_memsz);
    }
    return 1;  // The first object is the program itself.
  };
  dl_iterate_phdr(flush_program, nullptr);
  constexpr std::size_t kStack = 1 << 15;
  flush(static_cast<const char*>(__builtin_frame_address(0)) - kStack, kStack);
  flush(&job, sizeof job);
  _mm_mfence();
}
#endif

/// Number of involuntary context switches so far.
long preemptions() noexcept {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_nivcsw;
}

struct Options {
  double warm_calls = 1e7;
  double cold_calls = 1e5;
  double tick = tick_length();
  bool first = true;
};

template <typename Job>
[[gnu::noinline]] void time_once(Job& job, Histogram& histogram) {
  const std::uint64_t start = Clock::start();
  job();
  histogram.add(Clock::stop() - start);
}

/// An empty job of a given duration: arithmetic in a register, without memory accesses and without branches that vary.
struct Empty {
  int turns = 0;

  void operator()() noexcept {
    unsigned long x = 1;
    for (int i = 0; i < turns; ++i) {
      x *= 3;
      asm volatile("" : "+r"(x));
    }
  }
};

template <typename Job>
double median_time(Job& job) {
  Histogram histogram;
  for (int i = 0; i < 10000; ++i) time_once(job, histogram);
  return static_cast<double>(histogram.quantile(0.5));
}

/// An empty job with the same duration as the job.
template <typename Job>
Empty as_long_as(Job& job) {
  constexpr int kTurns = 1000;
  Empty none;
  Empty some{kTurns};
  const double least = median_time(none);
  const double turn = (median_time(some) - least) / kTurns;
  return {std::max(0, static_cast<int>((median_time(job) - least) / turn))};
}

void print(const char* prefix, const Histogram& histogram, double tick) {
  for (const auto& [name, fraction] : {std::pair{"p50", 0.5}, {"p99", 0.99}, {"p99.9", 0.999}, {"worst", 1.0}}) {
    std::printf(", \"%s%s\": %.1f", prefix, name, tick * static_cast<double>(histogram.quantile(fraction)));
  }
}

/// Prepares and times the job a number of times, alternating with the empty job if it is given, and prints a row.
template <typename Job, typename Prepare>
void time_all(const std::string& row, const char* caches, double calls, Job& job, Empty* empty, Prepare prepare,
              Options& options) {
  Histogram histogram;
  Histogram idle;
  const long before = preemptions();
  for (double i = 0; i < calls; ++i) {
    prepare();
    time_once(job, histogram);
    if (empty) time_once(*empty, idle);
  }
  std::printf("%s  {\"name\": \"%s\", \"caches\": \"%s\", \"calls\": %.0f, \"preempted\": %ld",
              options.first ? "" : ",\n", row.c_str(), caches, calls, preemptions() - before);
  print("", histogram, options.tick);
  if (empty) print("empty_", idle, options.tick);
  std::printf("}");
  std::fflush(stdout);
  options.first = false;
}

template <typename Job>
void time_warm_and_cold(const std::string& row, Options& options) {
  Job job;
  Empty empty = as_long_as(job);
  time_all(
      row, "warm", options.warm_calls, job, &empty, [] {}, options);
#ifdef FPBM_HAS_CLFLUSH
  time_all(
      row, "cold", options.cold_calls, job, nullptr, [&job] { evict(job); }, options);
#endif
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  Options options;
  if (argc > 1) options.warm_calls = std::atof(argv[1]);
  if (argc > 2) options.cold_calls = std::atof(argv[2]);
  using Planar4 = Case<Planar<4>, fpbm::Position<2>>;
  using PandaPosition = Case<Panda, fpbm::Position<3>>;
  std::printf("[\n");
  time_warm_and_cold<Nothing>("timer", options);
  time_warm_and_cold<Step<Ours<Planar4, Law::kMVN>>>("step/planar4/position/mvn", options);
  time_warm_and_cold<Step<Ours<Planar4, Law::kFPBM>>>("step/planar4/position/fpbm", options);
  time_warm_and_cold<Step<Ours<PandaPosition, Law::kFPBM>>>("step/panda/position/fpbm", options);
  time_warm_and_cold<Step<Ours<PandaPose, Law::kMVN>>>("step/panda/pose/mvn", options);
  time_warm_and_cold<Step<Ours<PandaPose, Law::kFPBM>>>("step/panda/pose/fpbm", options);
  time_warm_and_cold<Step<Ours<PandaPose, Law::kFPBM, true>>>("step/panda/pose/fpbm_damped", options);
  time_warm_and_cold<Measured>("loop/panda/pose/measured", options);
  time_warm_and_cold<Tick<false>>("loop/panda/pose/tick", options);
  std::printf("\n]\n");
}
