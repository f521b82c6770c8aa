// Two Pandas hold a tray on random object paths that saturate both arms. Prints the errors of the relative pose, and
// the excess over the bounds.
//
//     bench_grasp [motions = 10000] [first = 0] [threads]
//
// The relative pose is on the first level, the pose of the object on the second level, a posture on the third level.
// Every motion is executed twice, the second time with stop() at a random time. bench/grasp_worker.py generates the
// same motions from the same random numbers. Fails if a relative pose differs from the start by more than 1e-6 m or rad
// in any motion, or by more than 1e-9 in more than 1 % of the motions, or if a bound is exceeded by more than 1e-9.

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "fpbm/fpbm.hpp"

namespace {

using fpbm::Vector;
using Joints = Vector<14>;

constexpr double kDt = 1e-3;
constexpr int kTicks = 3000;
constexpr int kMove = 600;  ///< Ticks between waypoints. The tray is at rest at the last waypoint.
constexpr int kMoves = 4;

/// SplitMix64, which is simple to implement in Python too.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  double uniform(double size) {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return size * (2.0 * static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53 - 1.0);
  }
  Vector<3> vector(double size) {
    Vector<3> result;
    for (int i = 0; i < 3; ++i) result(i) = uniform(size);
    return result;
  }

 private:
  std::uint64_t state_;
};

/// Displacements of the object between waypoints, in 0.6 s each: faster than the arms.
class ObjectPath {
 public:
  explicit ObjectPath(Random& random) {
    for (int k = 1; k <= kMoves; ++k) {
      at_[k][0] = random.vector(0.5);
      at_[k][1] = random.vector(0.8);
    }
  }

  /// Pose, velocity and acceleration of the displaced position. For the orientation, the pose only.
  void set(int tick, const fpbm::Transform<>& start, fpbm::Reference<fpbm::Pose>& reference) const {
    const int k = std::min(tick / kMove, kMoves - 1);
    const double duration = kMove * kDt;
    const double s = std::min(static_cast<double>(tick - k * kMove) / kMove, 1.0);
    const double part = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    const double rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration;
    const double change = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (duration * duration);
    const Vector<3> p = at_[k + 1][0] - at_[k][0];
    const Vector<3> r = at_[k][1] + part * (at_[k + 1][1] - at_[k][1]);
    reference.x.p = start.p + at_[k][0] + part * p;
    reference.x.R = fpbm::rotation(r) * start.R;
    reference.xd.setZero();
    reference.xdd.setZero();
    reference.xd.head<3>() = rate * p;
    reference.xdd.head<3>() = change * p;
  }

 private:
  std::array<std::array<Vector<3>, 2>, kMoves + 1> at_{{{Vector<3>::Zero(), Vector<3>::Zero()}}};
};

/// Results of a motion.
struct Motion {
  double grasp = 0;              ///< Largest difference of the relative pose [m or rad].
  std::array<double, 5> excess;  ///< Excess of q [rad]; of Δq, Δ²q, Δ³q and Δ²q̇ relative to the bounds.
  bool both_saturated = false;   ///< Bounds were active on joints of both arms.
  bool at_rest = true;
  double time = 0;  ///< Total time of all ticks [ns].
};

Motion run(std::uint64_t seed, bool stops) {
  static const fpbm::Tree<> tree = fpbm::presets::two_pandas();
  static const fpbm::Robot<14> robot(tree);
  static const auto right = fpbm::frame_of(tree, "right_tip");
  static const auto left = fpbm::frame_of(tree, "left_tip");

  Random random(seed);
  const Vector<7> home{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785};
  Joints q0;
  for (int i = 0; i < 14; ++i) q0(i) = home(i % 7) + random.uniform(0.3);
  const ObjectPath path(random);
  const int stop = stops ? static_cast<int>(1500 + random.uniform(1200.0)) : -1;

  const fpbm::Stack stack(fpbm::RelativePoseTask<>{{left, {500.0, 62500.0}}, right},
                          fpbm::PoseTask<>{right, {10.0, 25.0}}, fpbm::PostureTask<14>{fpbm::TaskGains<>(4.0, 4.0)});
  const auto scheme = fpbm::Balanced<14>(0.0, fpbm::UnitWeights{}, fpbm::NullSpace<14>().with_damping(2.0));
  fpbm::TrackerOptions<> options;
  options.keep_first_level = true;
  auto tracker = fpbm::stack_tracker(robot, stack, scheme, q0, options);
  auto target = decltype(tracker)::Target::hold(tracker.tip());
  const auto start = target.x;

  Motion motion;
  motion.excess.fill(-1.0);
  const auto& limits = robot.limits();
  std::array<Joints, 4> q{q0, q0, q0, q0};
  std::array<Joints, 3> qd{Joints::Zero(), Joints::Zero(), Joints::Zero()};
  fpbm::Reference<fpbm::Pose> object;
  int saturated = 0;
  for (int k = 0; k < kTicks + 1000; ++k) {
    if (k == stop) tracker.stop();
    path.set(k, std::get<1>(start), object);
    std::get<1>(target.x) = object.x;
    target.xd.template segment<6>(6) = object.xd;
    target.xdd.template segment<6>(6) = object.xdd;
    const auto begin = std::chrono::steady_clock::now();
    const auto tick = tracker.tick(target);
    motion.time += std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count();
    for (int i = 0; i < 14; ++i) saturated |= (tick.saturated >> i & 1U) != 0 ? 1 << i / 7 : 0;
    const fpbm::Transform<> now = std::get<0>(tracker.tip());
    const fpbm::Transform<>& held = std::get<0>(start);
    const fpbm::Matrix<3, 3> turned = now.R * held.R.transpose();
    motion.grasp = std::max({motion.grasp, (now.p - held.p).norm(), fpbm::rotation_vector(turned).norm()});
    q = {tick.q, q[0], q[1], q[2]};
    qd = {tick.qd, qd[0], qd[1]};
    const auto exceed = [&](std::size_t i, const Joints& by) {
      motion.excess[i] = std::max(motion.excess[i], by.maxCoeff());
    };
    const auto share = [](const Joints& value, const Joints& bound) -> Joints {
      return (value.cwiseAbs().cwiseQuotient(bound).array() - 1.0).matrix();
    };
    exceed(0, (q[0] - limits.upper).cwiseMax(limits.lower - q[0]));
    exceed(1, share((q[0] - q[1]) / kDt, limits.velocity));
    exceed(2, share((q[0] - 2.0 * q[1] + q[2]) / (kDt * kDt), limits.acceleration));
    exceed(3, share((q[0] - 3.0 * q[1] + 3.0 * q[2] - q[3]) / (kDt * kDt * kDt), limits.jerk));
    exceed(4, share((qd[0] - 2.0 * qd[1] + qd[2]) / (kDt * kDt), limits.jerk));
  }
  motion.both_saturated = saturated == 3;
  motion.at_rest = !stops || qd[0].cwiseAbs().maxCoeff() < 1e-9;
  return motion;
}

std::vector<Motion> run_all(int first, int count, int threads, bool stops) {
  std::vector<Motion> motions(static_cast<std::size_t>(count));
  std::atomic<int> next{0};
  std::vector<std::thread> workers;
  for (int i = 0; i < threads; ++i) {
    workers.emplace_back([&] {
      for (int k = next++; k < count; k = next++) {
        motions[static_cast<std::size_t>(k)] = run(static_cast<std::uint64_t>(first + k), stops);
      }
    });
  }
  for (auto& worker : workers) worker.join();
  return motions;
}

/// Prints the results of the motions. Returns whether the results satisfy the conditions at the head of this file.
bool report(const std::vector<Motion>& motions, int first, const char* name) {
  const auto count = static_cast<double>(motions.size());
  std::vector<double> errors;
  std::array<double, 5> excess;
  excess.fill(-1.0);
  int both = 0, moving = 0;
  double time = 0;
  std::size_t worst = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const Motion& motion = motions[k];
    errors.push_back(motion.grasp);
    if (motion.grasp > motions[worst].grasp) worst = k;
    for (std::size_t i = 0; i < excess.size(); ++i) excess[i] = std::max(excess[i], motion.excess[i]);
    both += motion.both_saturated ? 1 : 0;
    moving += motion.at_rest ? 0 : 1;
    time += motion.time;
  }
  std::sort(errors.begin(), errors.end());
  const auto quantile = [&](double part) { return errors[static_cast<std::size_t>(part * (count - 1.0))]; };
  const auto above = [&](double bound) { return errors.end() - std::upper_bound(errors.begin(), errors.end(), bound); };
  std::printf("%zu motions %s; bounds were active in both arms in %d\n", motions.size(), name, both);
  std::printf("  relative pose [m or rad]: median %.1e, 99 %% %.1e, largest %.1e (motion %d)\n", quantile(0.5),
              quantile(0.99), errors.back(), first + static_cast<int>(worst));
  std::printf("  above 1e-6: %td (%.2f %%), above 1e-9: %td (%.2f %%)\n", above(1e-6),
              100.0 * static_cast<double>(above(1e-6)) / count, above(1e-9),
              100.0 * static_cast<double>(above(1e-9)) / count);
  std::printf("  the first above 1e-6:");
  int shown = 0;
  for (std::size_t k = 0; k < motions.size() && shown < 10; ++k) {
    if (motions[k].grasp > 1e-6 && ++shown > 0) std::printf(" %d", first + static_cast<int>(k));
  }
  std::printf("\n");
  std::printf("  excess over the bounds: q %.1e rad; shares: Δq %.1e, Δ²q %.1e, Δ³q %.1e, Δ²q̇ %.1e\n", excess[0],
              excess[1], excess[2], excess[3], excess[4]);
  std::printf("  not at rest: %d; mean tick %.1f µs\n", moving, time / count / (kTicks + 1000) / 1e3);
  std::fflush(stdout);
  const bool bounded = excess[0] < 1e-9 && excess[1] < 1e-9 && excess[2] < 1e-9 && excess[4] < 1e-9;
  return bounded && moving == 0 && above(1e-6) == 0 && 100 * above(1e-9) <= static_cast<std::ptrdiff_t>(motions.size());
}

}  // namespace

int main(int count, char** given) {
  const int motions = count > 1 ? std::atoi(given[1]) : 10000;
  const int first = count > 2 ? std::atoi(given[2]) : 0;
  const int threads = count > 3 ? std::atoi(given[3]) : static_cast<int>(std::thread::hardware_concurrency());
  bool kept = report(run_all(first, motions, threads, false), first, "along the path");
  kept &= report(run_all(first, motions, threads, true), first, "with stop() at a random time");
  return kept ? EXIT_SUCCESS : EXIT_FAILURE;
}
