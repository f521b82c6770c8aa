#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "dynamics_peer.hpp"
#include "fpbm/model/dynamics.hpp"

// Dynamics compared with Pinocchio: largest relative errors for robots from URDF files and for random trees, and times
// of τ and of M with the forward pass. Arguments: folders with URDF files (`make dynamics`).
namespace bench {
namespace {

constexpr int kOpen = Eigen::Dynamic;

struct Urdf {
  const char* name;
  const char* file;  ///< In one of the folders.
};
constexpr Urdf kPanda{"Panda", "panda_description/urdf/panda.urdf"};
constexpr Urdf kG1{"G1", "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf"};
constexpr Urdf kRobots[] = {
    kPanda, {"iiwa14", "kuka_iiwa/iiwa14/iiwa14.urdf"},        {"UR10e", "universal_robots/ur10e/ur10e.urdf"},
    kG1,    {"Talos", "talos_data/robots/talos_full_v2.urdf"}, {"TIAGo", "tiago_description/robots/tiago.urdf"},
};

/// The file of a robot in the first folder that has the file, or an empty path.
std::string found(const std::vector<std::string>& folders, const Urdf& robot) {
  for (const std::string& folder : folders) {
    const std::filesystem::path file = std::filesystem::path(folder) / robot.file;
    if (std::filesystem::exists(file)) return file.string();
  }
  return {};
}

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  Eigen::VectorXd vector(Eigen::Index n, double most) {
    return Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(-most, most); });
  }

 private:
  std::mt19937 generator_;
};

/// Largest difference from Pinocchio in the states of a robot, relative to the largest entry in these states.
class Error {
 public:
  template <typename A, typename B>
  void include(const A& ours, const B& theirs) {
    difference_ = std::max(difference_, (ours - theirs).cwiseAbs().maxCoeff());
    scale_ = std::max(scale_, theirs.cwiseAbs().maxCoeff());
  }
  [[nodiscard]] double value() const { return difference_ > 0.0 ? difference_ / scale_ : 0.0; }

 private:
  double difference_ = 0.0;
  double scale_ = 0.0;
};

/// tau, M, h, g, kinetic and potential energy.
constexpr std::size_t kQuantities = 6;
using Errors = std::array<double, kQuantities>;

/// Updates the largest errors.
void compare(DynamicsPeer& peer, const fpbm::Tree<>& tree, Random& random, int states, Errors& largest) {
  std::array<Error, kQuantities> errors;
  Eigen::Vector3d gravity(0.0, 0.0, -9.81);
  for (int i = 0; i < states; ++i) {
    peer.set_gravity(gravity);
    const fpbm::Dynamics<kOpen> dynamics(tree, fpbm::Vector<3>(gravity));
    const Eigen::VectorXd q = random.vector(dynamics.dof(), 3.0);
    const Eigen::VectorXd qd = random.vector(dynamics.dof(), 2.0);
    const Eigen::VectorXd qdd = random.vector(dynamics.dof(), 5.0);
    fpbm::Dynamics<kOpen>::State state;
    dynamics.robot().update(q, qd, state);
    errors[0].include(dynamics.inverse_dynamics(state, qdd), peer.torque(q, qd, qdd));
    errors[1].include(dynamics.mass_matrix(state), peer.mass_matrix(q));
    errors[2].include(dynamics.bias(state), peer.bias(q, qd));
    errors[3].include(dynamics.gravity_torque(state), peer.gravity_torque(q));
    const auto energy = [](double value) { return Eigen::VectorXd::Constant(1, value); };
    errors[4].include(energy(dynamics.kinetic_energy(state)), energy(peer.kinetic_energy(q, qd)));
    errors[5].include(energy(dynamics.potential_energy(state)), energy(peer.potential_energy(q)));
    gravity = random.vector(3, 10.0);
  }
  for (std::size_t k = 0; k < kQuantities; ++k) largest[k] = std::max(largest[k], errors[k].value());
}

/// Inertia of eight random point masses.
fpbm::LinkInertia<> random_inertia(Random& random) {
  fpbm::LinkInertia<> link;
  for (int i = 0; i < 8; ++i) link = fpbm::joined(link, {random.uniform(0.05, 0.5), random.vector(3, 0.3)});
  return link;
}

fpbm::Tree<> random_tree(Random& random) {
  fpbm::Tree<> tree;
  const int joints = 1 + static_cast<int>(random.uniform(0.0, 19.99));
  for (int i = 0; i < joints; ++i) {
    fpbm::TreeJoint<> each;
    fpbm::Joint<>& joint = each.joint;
    if (random.uniform(0.0, 1.0) < 0.3) joint.type = fpbm::JointType::kPrismatic;
    joint.placement = {random.vector(3, 0.5), fpbm::rotation(fpbm::Vector<3>(random.vector(3, 2.0)))};
    joint.axis = random.vector(3, 1.0);
    joint.moved = random_inertia(random);
    joint.drive.rotor_inertia = random.uniform(0.0, 0.2);
    // A link of the chain to the previous joint: Pinocchio's crba() requires the joints of a branch to be adjacent.
    each.parent = i;
    while (each.parent > 0 && random.uniform(0.0, 1.0) < 0.2) {
      each.parent = tree.joints[static_cast<std::size_t>(each.parent - 1)].parent;
    }
    tree.joints.push_back(each);
  }
  return tree;
}

void print(const char* name, std::size_t joints, const Errors& errors) {
  std::printf("%-22s %6zu", name, joints);
  for (const double error : errors) std::printf(" %9.1e", error);
  std::printf("\n");
}

/// Median time of a call [ns].
template <typename F>
double time_of(const F& f) {
  constexpr int kCalls = 256;  // Shorter than a time slice of the system: most runs are not interrupted.
  constexpr int kRuns = 301;
  std::vector<double> times;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < kCalls; ++i) {
      f(i % 64);
      asm volatile("" : : : "memory");
    }
    times.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() /
                    kCalls);
  }
  std::nth_element(times.begin(), times.begin() + kRuns / 2, times.end());
  return times[kRuns / 2];
}

template <int N>
void compare_times(const char* name, const std::string& urdf, const std::vector<std::string>& joints) {
  const fpbm::Tree<> tree = DynamicsPeer(urdf, joints).tree();
  const fpbm::Dynamics<N> dynamics(tree);
  typename fpbm::Dynamics<N>::State state;
  Random random(1);
  std::vector<Eigen::VectorXd> q;
  std::vector<Eigen::VectorXd> qd;
  std::vector<Eigen::VectorXd> qdd;
  std::vector<fpbm::Vector<N>> ours[3];
  for (int i = 0; i < 64; ++i) {
    q.push_back(random.vector(N, 1.5));
    qd.push_back(random.vector(N, 1.0));
    qdd.push_back(random.vector(N, 1.0));
    ours[0].emplace_back(q.back());
    ours[1].emplace_back(qd.back());
    ours[2].emplace_back(qdd.back());
  }
  const auto update = [&](std::size_t i) { dynamics.robot().update(ours[0][i], ours[1][i], state); };
  const auto set_torque = [&](std::size_t i) {
    const fpbm::Vector<N> torque = dynamics.inverse_dynamics(state, ours[2][i]);
    asm volatile("" : : "r"(&torque) : "memory");
  };
  const auto set_M = [&](std::size_t) {
    const fpbm::Matrix<N, N> M = dynamics.mass_matrix(state);
    asm volatile("" : : "r"(&M) : "memory");
  };
  DynamicsPeer peer(urdf, joints);
  const double forward = time_of(update);
  const double ours_torque = time_of([&](std::size_t i) { update(i), set_torque(i); });
  const double ours_M = time_of([&](std::size_t i) { update(i), set_M(i); });
  const double ours_both = time_of([&](std::size_t i) { update(i), set_torque(i), set_M(i); });
  const double rnea = time_of([&](std::size_t i) { peer.torque(q[i], qd[i], qdd[i]); });
  const double crba = std::min(time_of([&](std::size_t i) { peer.upper_mass_matrix(q[i]); }),
                               time_of([&](std::size_t i) { peer.upper_mass_matrix(q[i], true); }));
  const auto row = [&](const char* what, double mine, double theirs) {
    std::printf("%-22s %-26s %8.0f %10.0f %8.2f\n", name, what, mine, theirs, mine / theirs);
  };
  std::printf("%-22s %-26s %8.0f\n", name, "forward pass", forward);
  row("tau, with forward pass", ours_torque, rnea);
  row("M, with forward pass", ours_M, crba);
  row("both, one forward pass", ours_both, rnea + crba);
  row("tau alone", ours_torque - forward, rnea);
  row("M alone", ours_M - forward, crba);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  const std::vector<std::string> folders(argv + 1, argv + argc);
  Random random(1);
  Errors largest{};
  std::printf("Largest differences from Pinocchio, relative to the largest entry\n%-22s %6s %9s %9s %9s %9s %9s %9s\n",
              "robot", "joints", "tau", "M", "h", "g", "T", "U");
  for (const Urdf& robot : kRobots) {
    const std::string file = found(folders, robot);
    if (file.empty()) {
      std::printf("%-22s not found: %s\n", robot.name, robot.file);
      continue;
    }
    DynamicsPeer peer(file);
    const fpbm::Tree<> tree = peer.tree();
    Errors errors{};
    compare(peer, tree, random, 100, errors);
    print(robot.name, tree.joints.size(), errors);
    for (std::size_t k = 0; k < kQuantities; ++k) largest[k] = std::max(largest[k], errors[k]);
  }
  constexpr int kTrees = 1000;
  Errors errors{};
  std::size_t most = 0;
  for (int i = 0; i < kTrees; ++i) {
    const fpbm::Tree<> tree = random_tree(random);
    DynamicsPeer peer(tree);
    compare(peer, tree, random, 10, errors);
    most = std::max(most, tree.joints.size());
  }
  print("1,000 random trees", most, errors);
  for (std::size_t k = 0; k < kQuantities; ++k) largest[k] = std::max(largest[k], errors[k]);

  std::printf("\nMedian times [ns]\n%-22s %-26s %8s %10s %8s\n", "robot", "", "fpbm_cpp", "Pinocchio", "ratio");
  if (const std::string file = found(folders, kPanda); !file.empty()) {
    compare_times<7>("Panda", file, {"panda_joint"});
  }
  if (const std::string file = found(folders, kG1); !file.empty()) {
    compare_times<17>("G1, waist and arms", file, {"waist", "shoulder", "elbow", "wrist"});
  }
  constexpr double kRequired = 1e-12;
  return *std::max_element(largest.begin(), largest.end()) <= kRequired ? EXIT_SUCCESS : EXIT_FAILURE;
}
