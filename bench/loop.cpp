#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>
#include <vector>

#include "fpbm/fpbm.hpp"

// Cost of the limits in addition to a Panda pose step (tip, J, Jd and FPBM), and a whole tick of a control loop. Rows:
//   step              the step alone
//   step_limited/0    the step with its limits checked, none of them active
//   step_limited/1    each state exceeds the limits of the joints
//   measured, tick    Tracker::resolve_measured and Tracker::tick, on references within the limits

namespace {

using fpbm::Pose;
using Arm = fpbm::SerialArm<7>;
using Joints = fpbm::Vector<7>;

struct Input {
  fpbm::State<7> state;
  fpbm::Reference<Pose> reference;
};

Arm panda() {
  return Arm(fpbm::presets::panda());
}

auto scheme() {
  const fpbm::Vector<7> weights{1, 2, 3, 4, 1, 1, 1};
  return fpbm::FPBM<7>(0.6, weights, 10.0, 25.0, fpbm::NullSpace<7>{}.with_damping(2.0), fpbm::SingularDamping<>());
}

/// States around a bent posture, and references at a distance `far` [m, rad].
std::vector<Input> inputs(double far) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Joints bent;
  bent << 0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8;
  std::vector<Input> result(64);
  for (Input& input : result) {
    fpbm::Vector<6> displacement;
    for (int i = 0; i < 7; ++i) {
      input.state.q(i) = bent(i) + 0.2 * uniform(generator);
      input.state.qd(i) = 0.1 * uniform(generator);
    }
    for (int i = 0; i < 6; ++i) displacement(i) = far * uniform(generator);
    fpbm::Kinematics<Pose, 7> kinematics;
    panda().kinematics(input.state.q, input.state.qd, kinematics);
    input.reference = fpbm::Reference<Pose>::hold(Pose::displace<double>(kinematics.tip, displacement));
  }
  return result;
}

void step(benchmark::State& bench) {
  const Arm arm = panda();
  const auto fpbm = scheme();
  const auto ring = inputs(1e-3);
  std::size_t turn = 0;
  Joints qdd = Joints::Zero();
  for (auto _ : bench) {
    const Input& input = ring[++turn % ring.size()];
    fpbm::Kinematics<Pose, 7> kinematics;
    arm.kinematics(input.state.q, input.state.qd, kinematics);
    benchmark::DoNotOptimize(fpbm.resolve(kinematics, input.reference, input.state, qdd));
    benchmark::DoNotOptimize(qdd.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(step);

void step_limited(benchmark::State& bench) {
  const Arm arm = panda();
  const auto fpbm = scheme();
  const fpbm::Limiter<fpbm::Level::kAcceleration, 7> limiter({arm.limits(), 1e-3});
  const auto ring = inputs(bench.range(0) == 0 ? 1e-3 : 10.0);
  std::size_t turn = 0;
  int passes = 0;
  int most = 0;
  Joints qdd = Joints::Zero();
  for (auto _ : bench) {
    const Input& input = ring[++turn % ring.size()];
    fpbm::Kinematics<Pose, 7> kinematics;
    arm.kinematics(input.state.q, input.state.qd, kinematics);
    benchmark::DoNotOptimize(fpbm.resolve(kinematics, input.reference, input.state, qdd));
    auto kept = limiter.motion(kinematics.J, input.state, qdd);
    passes += kept.passes;
    most = std::max(most, kept.passes);
    benchmark::DoNotOptimize(kept.u.data());
    benchmark::ClobberMemory();
  }
  bench.counters["passes"] = static_cast<double>(passes) / static_cast<double>(bench.iterations());
  bench.counters["most"] = most;
}
BENCHMARK(step_limited)->Arg(0)->Arg(1);

void measured(benchmark::State& bench) {
  const auto ring = inputs(1e-3);
  fpbm::Tracker tracker(panda(), Pose{}, scheme(), ring[0].state.q);
  std::size_t turn = 0;
  for (auto _ : bench) {
    const Input& input = ring[++turn % ring.size()];
    auto tick = tracker.resolve_measured(input.state.q, input.state.qd, input.reference);
    benchmark::DoNotOptimize(tick.qdd.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(measured);

void tick(benchmark::State& bench) {
  const auto ring = inputs(1e-3);
  fpbm::Tracker tracker(panda(), Pose{}, scheme(), ring[0].state.q);
  const auto home = fpbm::Reference<Pose>::hold(tracker.tip());
  for (auto _ : bench) {
    auto result = tracker.tick(home);
    benchmark::DoNotOptimize(result.qdd.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(tick);

}  // namespace
