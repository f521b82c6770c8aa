#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "fpbm/fpbm.hpp"

// What one evaluation of each scheme costs, in rows named scheme/arm/part. See bench/README.md.

namespace {

using Space = fpbm::Position<2>;

/// What a resolver sees in one evaluation.
template <int N>
struct Input {
  fpbm::State<N> state;
  fpbm::Reference<Space> reference;
  fpbm::Kinematics<Space, N> kinematics;
};

/// Postures well away from singular ones, and references near the tip; the same on every run.
/// Iterations go round the ring, so that nothing can be hoisted; it is short enough to stay in the first-level cache.
template <typename Arm>
class Ring {
 public:
  static constexpr int N = Arm::kDof;

  explicit Ring(const Arm& arm) : inputs_(kSize) {
    std::mt19937 generator(1);
    const auto uniform = [&](Eigen::Index size, double low, double high) {
      std::uniform_real_distribution<double> distribution(low, high);
      fpbm::Vector<Eigen::Dynamic> values(size);
      for (double& value : values) value = distribution(generator);
      return values;
    };
    for (Input<N>& input : inputs_) {
      input.state = {uniform(arm.dof(), 0.1, 1.0), uniform(arm.dof(), -1.0, 1.0)};
      arm.kinematics(input.state.q, input.state.qd, input.kinematics);
      input.reference = {input.kinematics.tip + uniform(2, -0.1, 0.1), uniform(2, -1.0, 1.0), uniform(2, -1.0, 1.0)};
    }
  }

  [[nodiscard]] const Input<N>& next() noexcept { return inputs_[++turn_ % kSize]; }

 private:
  static constexpr std::size_t kSize = 64;

  std::vector<Input<N>> inputs_;
  std::size_t turn_ = 0;
};

/// Hands an object to the optimiser's blind spot: it may have been read and changed.
template <typename T>
void escape(T& object) {
  benchmark::DoNotOptimize(&object);
  benchmark::ClobberMemory();
}

template <fpbm::Level kLevel, typename Arm, int N>
void evaluate_kinematics(const Arm& arm, const fpbm::State<N>& state, fpbm::Kinematics<Space, N>& out) noexcept {
  if constexpr (kLevel == fpbm::Level::kAcceleration) {
    arm.kinematics(state.q, state.qd, out);
  } else {
    arm.kinematics(state.q, out);
  }
}

template <fpbm::Level kLevel, typename Arm>
void kinematics(benchmark::State& bench, Arm arm) {
  Ring<Arm> ring(arm);
  fpbm::Kinematics<Space, Arm::kDof> out;
  escape(arm);
  for (auto _ : bench) {
    evaluate_kinematics<kLevel>(arm, ring.next().state, out);
    escape(out);
  }
}

template <typename Arm, typename Scheme>
void resolve(benchmark::State& bench, const Arm& arm, Scheme scheme) {
  Ring<Arm> ring(arm);
  fpbm::Vector<Arm::kDof> out;
  escape(scheme);
  for (auto _ : bench) {
    const Input<Arm::kDof>& input = ring.next();
    auto status = scheme.resolve(input.kinematics, input.reference, input.state, out);
    escape(status);
    escape(out);
  }
}

template <typename Arm, typename Scheme>
void step(benchmark::State& bench, Arm arm, Scheme scheme) {
  Ring<Arm> ring(arm);
  fpbm::Kinematics<Space, Arm::kDof> kinematics;
  fpbm::Vector<Arm::kDof> out;
  escape(arm);
  escape(scheme);
  for (auto _ : bench) {
    const Input<Arm::kDof>& input = ring.next();
    evaluate_kinematics<Scheme::kLevel>(arm, input.state, kinematics);
    auto status = scheme.resolve(kinematics, input.reference, input.state, out);
    escape(status);
    escape(out);
  }
}

/// One RK4 step of 1 ms along the paper's circle, as rollout() takes it: time goes on from tick to tick.
template <typename Arm, typename Scheme>
void tick(benchmark::State& bench, Arm arm, Scheme scheme) {
  using Loop = fpbm::ClosedLoop<Arm, Scheme, Space>;
  using X = typename Loop::X;
  constexpr double kDt = 1e-3;
  constexpr int kTicks = 10000;

  Ring<Arm> ring(arm);
  fpbm::Path path(fpbm::Circle(0.45), kDt * kTicks);
  const Input<Arm::kDof>& start = ring.next();
  Loop loop{arm, scheme, start.kinematics, start.state, start.state.qd};
  fpbm::AnchoredPath references(path, start.kinematics.tip);
  const auto derivative = [&](double t, const X& x, X& dx) noexcept {
    return loop.evaluate(references.motion(t, t), x, dx);
  };
  X x(arm.dof(), Loop::kSecondOrder ? 2 : 1);
  escape(arm);
  escape(scheme);
  escape(path);
  int count = 0;
  for (auto _ : bench) {
    const Input<Arm::kDof>& input = ring.next();
    x.col(0) = input.state.q;
    if constexpr (Loop::kSecondOrder) x.col(1) = input.state.qd;
    auto status = fpbm::RK4::step(derivative, kDt * count, kDt, x);
    count = (count + 1) % kTicks;
    escape(status);
    escape(x);
  }
}

double least(const std::vector<double>& times) {
  return *std::min_element(times.begin(), times.end());
}

template <typename Function>
void add(const std::string& name, const Function& function) {
  benchmark::RegisterBenchmark(name.c_str(), function)->ComputeStatistics("min", least);
}

template <typename Arm, typename Scheme>
void add_scheme(const std::string& scheme_name, const std::string& arm_name, const Arm& arm, const Scheme& scheme) {
  const std::string name = scheme_name + "/" + arm_name + "/";
  add(name + "resolve", [=](benchmark::State& bench) { resolve(bench, arm, scheme); });
  add(name + "step", [=](benchmark::State& bench) { step(bench, arm, scheme); });
  add(name + "tick", [=](benchmark::State& bench) { tick(bench, arm, scheme); });
}

template <typename Arm>
void add_kinematics(const std::string& arm_name, const Arm& arm) {
  using fpbm::Level;
  const std::string name = "kinematics/" + arm_name + "/";
  add(name + "velocity", [=](benchmark::State& bench) { kinematics<Level::kVelocity>(bench, arm); });
  add(name + "acceleration", [=](benchmark::State& bench) { kinematics<Level::kAcceleration>(bench, arm); });
}

/// Weights 1, 2, …, n, as the paper has them.
template <int N>
fpbm::Vector<N> rising_weights(Eigen::Index dof) {
  return fpbm::Vector<N>::LinSpaced(dof, 1.0, static_cast<double>(dof));
}

template <int N>
void add_fixed(const std::string& arm_name) {
  const fpbm::PlanarArm<N> arm(fpbm::Vector<N>::Ones());
  const fpbm::Vector<N> w = rising_weights<N>(N);
  const fpbm::DiagonalWeights<N> diagonal(w);
  fpbm::Matrix<N, N> W = w.asDiagonal();
  W.array() += 0.1;
  const fpbm::DenseWeights<N> dense(W);
  const auto damping = fpbm::NullSpace<N>().with_damping(2.0);

  add_kinematics(arm_name, arm);
  add_scheme("mvn", arm_name, arm, fpbm::MVN<N>());
  add_scheme("wmvn", arm_name, arm, fpbm::WMVN<N>(diagonal));
  add_scheme("man", arm_name, arm, fpbm::MAN<N>());
  add_scheme("wmvn_acceleration", arm_name, arm, fpbm::WMVNAcceleration<N>(diagonal));
  add_scheme("balanced", arm_name, arm, fpbm::Balanced<N>(0.6, diagonal));
  add_scheme("fpbm", arm_name, arm, fpbm::FPBM<N>(0.6, diagonal, 1.0, 1.0));
  add_scheme("fpbm_dense", arm_name, arm, fpbm::FPBM<N, double, fpbm::DenseWeights<N>>(0.6, dense, 1.0, 1.0));
  add_scheme("fpbm_damped", arm_name, arm, fpbm::FPBM<N>(0.6, diagonal, 1.0, 1.0, damping));
}

/// The number of joints given at run time, for comparison.
void add_dynamic(const std::string& arm_name, Eigen::Index dof) {
  constexpr int N = Eigen::Dynamic;
  const fpbm::PlanarArm<N> arm(fpbm::Vector<N>::Ones(dof));
  const fpbm::DiagonalWeights<N> weights(rising_weights<N>(dof));
  add_kinematics(arm_name, arm);
  add_scheme("fpbm", arm_name, arm, fpbm::FPBM<N>(0.6, weights, 1.0, 1.0));
}

[[maybe_unused]] const bool kRegistered = [] {
  add_fixed<4>("planar4");
  add_fixed<7>("planar7");
  add_dynamic("planar7_dynamic", 7);
  return true;
}();

}  // namespace
