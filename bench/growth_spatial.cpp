#include "growth.hpp"

// Spatial arms with pose tasks.
namespace bench {
namespace {

/// Links of 0.3 m. Each joint axis is perpendicular to the previous axis.
template <int N>
struct Spatial {
  static constexpr int kDof = N;
  using Arm = fpbm::SerialArm<N>;

  static fpbm::Chain<> chain() {
    fpbm::Chain<> chain;
    chain.joints.resize(N);
    chain.tip.p(2) = 0.3;
    for (std::size_t i = 1; i < N; ++i) {
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

/// A spatial arm of n joints, with n known at run time.
template <int n>
struct Planned : Spatial<n> {
  static constexpr int kDof = Eigen::Dynamic;
  using Arm = fpbm::SerialArm<kDof>;

  static Arm arm() { return Arm(Spatial<n>::chain()); }
  static fpbm::Vector<kDof> bent() { return fpbm::Vector<kDof>::Constant(n, 0.6); }
};

template <int... n>
bool add_all(std::integer_sequence<int, n...>) {
  (add_growth<Spatial<n>, fpbm::Pose>("spatial", "fixed", n), ...);
  (add_growth<Planned<n>, fpbm::Pose>("spatial", "run_time", n), ...);
  return true;
}

using Sizes = std::integer_sequence<int, 7, 8, 10, 12, 16, 24, 32>;
[[maybe_unused]] const bool kAdded = add_all(Sizes{});

}  // namespace
}  // namespace bench
