#include "step.hpp"

// Steps of FPBM on arms of n joints, and their kinematics alone, n fixed at compile time or given at run time: rows
// growth/planar/step/fixed/n, … Planar arms have positions for tasks, spatial ones poses.
namespace bench {
namespace {

/// Links of 0.3 m, each joint's axis at right angles to the last one's.
template <int N>
struct Spatial {
  static constexpr int kDof = N;
  using Arm = fpbm::SerialArm<N>;

  static fpbm::Chain<> chain(std::size_t n = N) {
    fpbm::Chain<> chain;
    chain.joints.resize(n);
    chain.tip.p(2) = 0.3;
    for (std::size_t i = 1; i < n; ++i) {
      const double turn = i % 2 == 0 ? 1.0 : -1.0;
      chain.joints[i].placement.R << 1, 0, 0, 0, 0, -turn, 0, turn, 0;
      chain.joints[i].placement.p(2) = 0.3;
    }
    return chain;
  }
  static std::string name() { return "spatial" + std::to_string(N); }
  static Arm arm() { return Arm(chain()); }
  static fpbm::Vector<N> bent() { return fpbm::Vector<N>::Constant(0.6); }
};

/// Such arms of n joints, n known at run time.
template <int n>
struct PlannedPlanar : Planar<n> {
  static constexpr int kDof = Eigen::Dynamic;
  using Arm = fpbm::PlanarArm<kDof>;

  static Arm arm() { return Arm(fpbm::Vector<kDof>::Ones(n)); }
  static fpbm::Vector<kDof> bent() { return fpbm::Vector<kDof>::Constant(n, 0.6); }
};
template <int n>
struct PlannedSpatial : Spatial<n> {
  static constexpr int kDof = Eigen::Dynamic;
  using Arm = fpbm::SerialArm<kDof>;

  static Arm arm() { return Arm(Spatial<n>::chain()); }
  static fpbm::Vector<kDof> bent() { return fpbm::Vector<kDof>::Constant(n, 0.6); }
};

template <typename Robot, typename Space>
void add(const std::string& kind, const char* size, int n) {
  using Solver = Ours<Case<Robot, Space>, Law::kFPBM>;
  const std::string end = std::string("/") + size + "/" + std::to_string(n);
  benchmark::RegisterBenchmark(("growth/" + kind + "/kinematics" + end).c_str(), run<Move<Solver>>);
  benchmark::RegisterBenchmark(("growth/" + kind + "/step" + end).c_str(), run<Step<Solver>>);
}

template <int... n>
bool add_planar(std::integer_sequence<int, n...>) {
  (add<Planar<n + 4>, fpbm::Position<2>>("planar", "fixed", n + 4), ...);
  (add<PlannedPlanar<n + 4>, fpbm::Position<2>>("planar", "run_time", n + 4), ...);
  return true;
}
template <int... n>
bool add_spatial(std::integer_sequence<int, n...>) {
  (add<Spatial<n>, fpbm::Pose>("spatial", "fixed", n), ...);
  (add<PlannedSpatial<n>, fpbm::Pose>("spatial", "run_time", n), ...);
  return true;
}

[[maybe_unused]] const bool kAdded = add_planar(std::make_integer_sequence<int, fpbm::kMaxDof - 3>()) &&
                                     add_spatial(std::integer_sequence<int, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32>());

}  // namespace
}  // namespace bench
