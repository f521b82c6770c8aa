// A control loop at 1 kHz on POSIX: a Panda draws circles, moves toward an unreachable target, returns and stops. Then
// the program prints histograms of its timing.
//   example_07_realtime_loop [seconds to run, 10] [ticks per second, 1000]    Ctrl-C stops the arm and the program.
// This example has no Python version: an interpreter may pause at any time, but this loop must not pause.

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fpbm/fpbm.hpp>
#include <fpbm/realtime/tracker.hpp>

using Joints = fpbm::Vector<7>;
using Nanoseconds = std::int64_t;
constexpr Nanoseconds kSecond = 1000000000;

volatile std::sig_atomic_t interrupted = 0;

/// Counts durations in a fixed array: 48 bins per decade, from 0.1 µs to 1 s.
class Histogram {
 public:
  void add(Nanoseconds duration) noexcept {
    const double decades = std::log10(std::max(static_cast<double>(duration), kLeast) / kLeast);
    ++bins_[std::min(static_cast<std::size_t>(decades * kPerDecade), bins_.size() - 1)];
    ++total_;
    worst_ = std::max(worst_, duration);
  }

  void print(const char* title) const {
    std::printf("\n%s [µs]: p50 %.1f, p99 %.1f, p99.9 %.1f, worst %.1f\n", title, quantile(0.5), quantile(0.99),
                quantile(0.999), static_cast<double>(worst_) * 1e-3);
    for (std::size_t first = 0; first < bins_.size(); first += kPerRow) {
      long count = 0;
      for (std::size_t i = first; i < first + kPerRow; ++i) count += bins_[i];
      if (count == 0) continue;
      // The length of a bar is the logarithm of the count, so that a single late tick is visible beside many thousands.
      const int bar = 1 + static_cast<int>(8.0 * std::log10(static_cast<double>(count)));
      std::printf("%9.1f to %9.1f %8ld %.*s\n", edge(first), edge(first + kPerRow), count, bar, kBar);
    }
  }

 private:
  static constexpr std::size_t kPerDecade = 48;
  static constexpr std::size_t kPerRow = kPerDecade / 3;
  static constexpr double kLeast = 100.0;  // [ns]
  static constexpr const char* kBar = "################################################################";

  /// Lower edge of a bin [µs].
  [[nodiscard]] static double edge(std::size_t bin) {
    return kLeast * std::pow(10.0, static_cast<double>(bin) / kPerDecade) * 1e-3;
  }

  /// Upper edge of the bin that contains the quantile [µs], at most 5 % too high.
  [[nodiscard]] double quantile(double share) const {
    std::size_t bin = 0;
    for (long below = bins_[0]; static_cast<double>(below) < share * static_cast<double>(total_);) {
      below += bins_[++bin];
    }
    return std::min(edge(bin + 1), static_cast<double>(worst_) * 1e-3);
  }

  std::array<long, 7 * kPerDecade> bins_{};
  long total_ = 0;
  Nanoseconds worst_ = 0;
};

Nanoseconds now() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return kSecond * time.tv_sec + time.tv_nsec;
}

/// Sleeps until an absolute time, so that a late tick does not delay the next tick.
void sleep_until(Nanoseconds when) noexcept {
  const timespec time{when / kSecond, when % kSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

/// Sets a real-time priority, and locks all memory: no page fault occurs during a tick.
void become_realtime() {
  sched_param priority{};
  priority.sched_priority = 80;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority)) {
    std::printf("no real-time priority (%s): other programs may delay a tick\n", std::strerror(error));
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    std::printf("memory is not locked (%s): a page fault may delay a tick\n", std::strerror(errno));
  }
  volatile char stack[256 * 1024];
  for (std::size_t i = 0; i < sizeof stack; i += 1024) stack[i] = 0;
}

/// A number from the command line, or its default value.
double argument(int count, char** values, int index, double standard, double most) {
  if (index >= count) return standard;
  char* end = nullptr;
  const double value = std::strtod(values[index], &end);
  if (*end == '\0' && value > 0.0 && value <= most) return value;
  std::fprintf(stderr, "%s: must be a number above 0, at most %g\n", values[index], most);
  std::exit(2);
}

int main(int argc, char** argv) {
  const double seconds = argument(argc, argv, 1, 10.0, 1e6);
  const double rate = argument(argc, argv, 2, 1000.0, 2e4);  // [Hz]

  constexpr double kPi = fpbm::kTwoPi / 2.0;
  const Joints ready{0.0, -kPi / 4, 0.0, -3 * kPi / 4, 0.0, kPi / 2, kPi / 4};  // [rad], the hand points down
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  const auto homeward = fpbm::NullSpace<7>().with_damping(4.0).with_rest_posture(ready, 4.0);
  const auto scheme = fpbm::FPBM<7>(0.6, Joints{8, 8, 4, 4, 2, 1, 1}, 20.0, 100.0, homeward);  // alpha, W, k1, k2, z
  fpbm::TrackerOptions<> options;
  options.dt = 1.0 / rate;
  fpbm::Tracker tracker(arm, fpbm::Pose{}, scheme, ready, options);

  const auto start = tracker.tip();
  const fpbm::InPlane circle(fpbm::Path(fpbm::Circle(0.1), 3.0, fpbm::Quintic{}),  // radius [m], duration [s]
                             {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  const fpbm::WithRotation path(circle);  // The orientation is constant.
  const fpbm::PathFollower lap(path, start);
  auto follower = lap;
  const auto back = fpbm::Reference<fpbm::Pose>::hold(start);
  auto beyond = back;
  beyond.x.p(0) += 1.0;  // [m], unreachable

  Histogram lateness, compute;
  std::array<long, static_cast<std::size_t>(fpbm::Status::kNotFinite) + 1> seen{};  // Number of ticks with each status.
  long missed = 0;
  double error = 0.0, orientation_error = 0.0, speed = 0.0;
  std::signal(SIGINT, [](int) { interrupted = 1; });
  become_realtime();

  // From here to the end of the loop: no allocation, no input or output, no lock.
  const auto period = static_cast<Nanoseconds>(std::llround(1e9 / rate));
  const Nanoseconds begin = now() + period;
  Nanoseconds deadline = begin;
  bool stopping = false, at_rest = false;
  while (!at_rest) {
    sleep_until(deadline);
    const Nanoseconds awake = now();
    lateness.add(awake - deadline);

    // Circles for 60 % of the time, then motion toward the unreachable target for 20 %, back for 20 %, and the stop.
    const double share = static_cast<double>(deadline - begin) * 1e-9 / seconds;
    if (!stopping && (interrupted || share >= 1.0)) {
      stopping = true;
      tracker.stop();
    }
    if (follower.done()) follower = lap;
    const bool circling = share < 0.6;
    const auto tick = circling ? tracker.tick(follower) : tracker.tick(share < 0.8 ? beyond : back);
    // Send tick.q or tick.qd to the drives here.

    ++seen[static_cast<std::size_t>(tick.status)];
    if (circling && !stopping) {
      error = std::max(error, tick.error.head<3>().norm());
      orientation_error = std::max(orientation_error, tick.error.tail<3>().norm());
    }
    speed = tick.qd.cwiseAbs().maxCoeff();
    at_rest = stopping && speed < 1e-9;

    // A missed deadline is skipped and not repeated: the arm is late by one tick, but does not jump.
    const Nanoseconds done = now();
    compute.add(done - awake);
    for (deadline += period; deadline <= done; deadline += period) ++missed;
  }

  long ticks = 0;
  for (const long count : seen) ticks += count;
  std::printf("%ld ticks at %g Hz, %ld deadlines missed\n", ticks, rate, missed);
  lateness.print("wake-up latency");
  compute.print("time to compute a tick");
  std::printf("\non the circle at most %.1e m and %.1e rad off; at the end %.0e rad/s\n", error, orientation_error,
              speed);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] > 0) std::printf("%8ld ticks: %s\n", seen[i], fpbm::message(static_cast<fpbm::Status>(i)));
  }
}
