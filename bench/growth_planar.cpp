#include "growth.hpp"

// Planar arms with position tasks, up to the largest number of joints.
namespace bench {
namespace {

/// A planar arm of n joints, with n known at run time.
template <int n>
struct Planned : Planar<n> {
  static constexpr int kDof = Eigen::Dynamic;
  using Arm = fpbm::PlanarArm<kDof>;

  static Arm arm() { return Arm(fpbm::Vector<kDof>::Ones(n)); }
  static fpbm::Vector<kDof> bent() { return fpbm::Vector<kDof>::Constant(n, 0.6); }
};

template <int... n>
bool add_all(std::integer_sequence<int, n...>) {
  using Space = fpbm::Position<2>;
  (add_growth<Planar<n>, Space>("planar", "fixed", n), ...);
  (add_growth<Planned<n>, Space>("planar", "run_time", n), ...);
  return true;
}

using Sizes = std::integer_sequence<int, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32>;
[[maybe_unused]] const bool kAdded = add_all(Sizes{});

}  // namespace
}  // namespace bench
