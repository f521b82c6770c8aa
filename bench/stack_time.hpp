#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "stack_motion.hpp"

// Times of several solvers on the same states, with interleaved calls.
namespace bench::stack {

/// A function of Asked with a name.
template <typename Case>
struct Row {
  std::string name;
  std::function<void(const Asked<Case>&, Joints&)> step;
};

/// Times of a row [ns].
struct Times {
  std::vector<double> rounds;  ///< Mean step of each round.
  std::vector<double> calls;   ///< Every call.
  std::vector<double> least;   ///< For each state, the smallest of all calls, without the noise of the machine.
};

inline double now() {
  using namespace std::chrono;
  return duration<double, std::nano>(steady_clock::now().time_since_epoch()).count();
}

/// Rounds in blocks of 64 states, then single calls. Each round times all rows on the same states, one after another.
template <typename Case>
std::vector<Times> time_rows(const std::vector<Row<Case>>& rows, const std::vector<Asked<Case>>& states, int rounds,
                             int passes) {
  constexpr std::size_t kBlock = 64;
  std::vector<Times> times(rows.size());
  Joints u;
  for (int r = 0; r < rounds; ++r) {
    const std::size_t first = kBlock * static_cast<std::size_t>(r);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::size_t i = (k + static_cast<std::size_t>(r)) % rows.size();
      const double begin = now();
      for (std::size_t j = 0; j < kBlock; ++j) {
        rows[i].step(states[(first + j) % states.size()], u);
        asm volatile("" : : "g"(&u) : "memory");
      }
      times[i].rounds.push_back((now() - begin) / static_cast<double>(kBlock));
    }
  }
  for (Times& each : times) each.least.assign(states.size(), 1e300);
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t s = 0; s < states.size(); ++s) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double begin = now();
        rows[i].step(states[s], u);
        asm volatile("" : : "g"(&u) : "memory");
        const double time = now() - begin;
        times[i].calls.push_back(time);
        times[i].least[s] = std::min(times[i].least[s], time);
      }
    }
  }
  return times;
}

/// A row as JSON. Ratios are relative to the first row, within a round.
inline void print(const std::string& name, const Times& times, const Times& ours) {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < times.rounds.size(); ++r) ratios.push_back(times.rounds[r] / ours.rounds[r]);
  std::printf("{\"name\": \"%s\", \"ratio\": %.4g, \"ratio_of_least\": %.4g", name.c_str(), quantile(ratios, 0.5),
              quantile(times.rounds, 0.0) / quantile(ours.rounds, 0.0));
  std::printf(", \"least\": %.5g, \"median\": %.5g", quantile(times.rounds, 0.0), quantile(times.rounds, 0.5));
  for (const auto& [key, fraction] : {std::pair{"p50", 0.5}, {"p99.9", 0.999}}) {
    std::printf(", \"%s\": %.5g, \"work_%s\": %.5g", key, quantile(times.calls, fraction), key,
                quantile(times.least, fraction));
  }
  std::printf("}");
}

}  // namespace bench::stack
