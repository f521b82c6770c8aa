#include "step.hpp"

// A step of FPBM on planar arms of n joints, n fixed at compile time or given at run time: rows growth/fixed/n, …
namespace bench {
namespace {

/// A planar arm of n joints, n known at run time.
template <int n>
struct Planned : Planar<n> {
  static constexpr int kDof = Eigen::Dynamic;
  using Arm = fpbm::PlanarArm<kDof>;

  static Arm arm() { return Arm(fpbm::Vector<kDof>::Ones(n)); }
  static fpbm::Vector<kDof> bent() { return fpbm::Vector<kDof>::Constant(n, 0.6); }
};

template <typename Robot>
void add(const char* size, int n) {
  using Solver = Ours<Case<Robot, fpbm::Position<2>>, Law::kFPBM>;
  const std::string row = std::string("growth/") + size + "/" + std::to_string(n);
  benchmark::RegisterBenchmark(row.c_str(), run<Step<Solver>>);
}

template <int... n>
bool add_all(std::integer_sequence<int, n...>) {
  (add<Planar<n>>("fixed", n), ...);
  (add<Planned<n>>("run_time", n), ...);
  return true;
}

[[maybe_unused]] const bool kAdded = add_all(std::integer_sequence<int, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 30>());

}  // namespace
}  // namespace bench
