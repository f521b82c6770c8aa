// Times of InverseKinematics for random poses that an arm reaches, for the next waypoint of a path, and for unreachable
// poses. Each answer is checked by the kinematics of the arm. usage: bench_inverse [number of poses]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fpbm/core/lanes.hpp>
#include <fpbm/fpbm.hpp>
#include <random>
#include <vector>

namespace {

using fpbm::Pose;
using fpbm::Vector;
using Clock = std::chrono::steady_clock;

#ifdef FPBM_LANES
using Batch = fpbm::Lanes<FPBM_LANES>;
#else
using Batch = double;
#endif

/// Times of many calls [µs].
struct Times {
  std::vector<double> all;

  void add(Clock::time_point begin) {
    all.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
  }
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const double time : all) sum += time;
    return sum / static_cast<double>(all.size());
  }
  [[nodiscard]] double quantile(double fraction) {
    std::sort(all.begin(), all.end());
    return all[std::min(all.size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(all.size())))];
  }
};

template <int N>
class Arm {
  using Joints = Vector<N>;

 public:
  Arm(const char* name, const fpbm::Chain<>& chain, int poses)
      : name_(name),
        poses_(poses),
        arm_(chain),
        reach_(arm_.length() + chain.joints.front().placement.p.norm()),
        inverse_(arm_, Pose{}, options()),
        with_default_starts_(arm_, Pose{}) {}

  void print() {
    Times reachable;
    int solved = 0;
    int wrong = 0;
    int most = 0;
    for (int i = 0; i < poses_; ++i) {
      const auto target = tip(random());
      const Joints start = random();
      const auto begin = Clock::now();
      const auto found = inverse_.solve(target, start);
      reachable.add(begin);
      solved += found.solved() ? 1 : 0;
      wrong += found.solved() && !is_at(target, found.q) ? 1 : 0;
      most = std::max(most, found.starts);
    }
    std::printf("%-8s %6d of %d, wrong %d, starts at most %3d; mean %5.1f, median %5.1f, p99 %5.1f, p99.9 %6.1f us",
                name_, solved, poses_, wrong, most, reachable.mean(), reachable.quantile(0.5), reachable.quantile(0.99),
                reachable.quantile(0.999));
    print_waypoints();
    print_unreachable();
  }

 private:
  [[nodiscard]] static fpbm::InverseOptions<> options() {
    fpbm::InverseOptions<> options;
    options.starts = 256;
    return options;
  }
  [[nodiscard]] Joints random() {
    constexpr double kHalfTurn = fpbm::kTwoPi / 2;
    Joints q;
    for (int i = 0; i < N; ++i) {
      const double lower = arm_.limits().lower(i);
      const double upper = arm_.limits().upper(i);
      const bool turns = upper - lower > fpbm::kTwoPi;
      q(i) = std::uniform_real_distribution<>(turns ? -kHalfTurn : lower, turns ? kHalfTurn : upper)(engine_);
    }
    return q;
  }
  [[nodiscard]] fpbm::Transform<> tip(const Joints& q) const {
    fpbm::Kinematics<Pose, N> kinematics;
    arm_.kinematics(q, kinematics);
    return kinematics.tip;
  }
  [[nodiscard]] bool is_at(const fpbm::Transform<>& target, const Joints& q) const {
    const auto e = Pose::difference<double>(target, tip(q));
    return e.template head<3>().norm() <= 1e-6 && e.template tail<3>().norm() <= 1e-6 &&
           (q.array() >= arm_.limits().lower.array()).all() && (q.array() <= arm_.limits().upper.array()).all();
  }

  /// A posture near q, within the ranges, whose tip is about 1 cm and 2 degrees away, by a step of MVN. Returns false
  /// if q is near a singular posture or near the ends of the ranges.
  [[nodiscard]] bool next_waypoint(const Joints& q, Joints& next) {
    constexpr double kLargest = 0.3;  // [rad]
    auto reference = fpbm::Reference<Pose>::hold(tip(q));
    for (int i = 0; i < 6; ++i) reference.xd(i) = std::normal_distribution<>()(engine_);
    reference.xd.template head<3>() *= 0.01 / reference.xd.template head<3>().norm();
    reference.xd.template tail<3>() *= 2.0 * fpbm::kTwoPi / 360.0 / reference.xd.template tail<3>().norm();
    fpbm::Kinematics<Pose, N> kinematics;
    arm_.kinematics(q, kinematics);
    Joints step;
    if (failed(fpbm::MVN<N>().resolve(kinematics, reference, {q, q}, step))) return false;
    next = q + step;
    return step.cwiseAbs().maxCoeff() <= kLargest && (next.array() >= arm_.limits().lower.array()).all() &&
           (next.array() <= arm_.limits().upper.array()).all();
  }

  /// The next waypoint from the posture at the waypoint before, and a step of MVN for comparison.
  void print_waypoints() {
    Times waypoint;
    int same = 0;
    for (int i = 0; i < poses_; ++i) {
      Joints q = random();
      Joints next;
      while (!next_waypoint(q, next)) q = random();
      const auto target = tip(next);
      const auto begin = Clock::now();
      const auto found = inverse_.solve(target, q);
      waypoint.add(begin);
      same += found.starts == 1 && (found.q - q).norm() <= 2.0 * (next - q).norm() ? 1 : 0;
    }
    const auto scheme = fpbm::MVN<N>();
    fpbm::Kinematics<Pose, N> kinematics;
    Joints q =
        (arm_.limits().lower + arm_.limits().upper).unaryExpr([](double x) { return std::isfinite(x) ? x / 3 : 0.5; });
    Joints qd = Joints::Zero();
    auto reference = fpbm::Reference<Pose>::hold(tip(q));
    reference.xd(0) = 0.1;
    constexpr int kSteps = 1000000;
    const auto begin = Clock::now();
    for (int i = 0; i < kSteps; ++i) {
      q(0) += 1e-9;
      arm_.kinematics(q, kinematics);
      (void)scheme.resolve(kinematics, reference, {q, qd}, qd);
      qd *= 1e-9;
      q += qd;
    }
    Times steps;
    steps.add(begin);
    std::printf("; waypoint: mean %4.2f us, %4.1f steps of MVN, same branch %d", waypoint.mean(),
                waypoint.mean() / (steps.mean() / kSteps), same);
  }

  /// Positions at 1.05 to 2 times the largest distance that the arm reaches.
  void print_unreachable() {
    Times unreachable;
    int found_any = 0;
    for (int i = 0; i < poses_; ++i) {
      auto target = tip(random());
      target.p *= reach_ * std::uniform_real_distribution<>(1.05, 2.0)(engine_) / target.p.norm();
      const auto begin = Clock::now();
      found_any += with_default_starts_.solve(target, random()).solved() ? 1 : 0;
      unreachable.add(begin);
    }
    std::printf("; unreachable: found %d, mean %4.0f us, longest %4.0f us\n", found_any, unreachable.mean(),
                unreachable.quantile(1.0));
  }

  const char* name_;
  int poses_;
  fpbm::SerialArm<N> arm_;
  double reach_;  ///< Upper bound [m].
  fpbm::InverseKinematics<fpbm::SerialArm<N>, Pose, Batch> inverse_;
  fpbm::InverseKinematics<fpbm::SerialArm<N>, Pose, Batch> with_default_starts_;
  std::mt19937 engine_{1};
};

/// Arm of PAL Robotics' TIAGo, from torso_lift_link to arm_tool_link. The numbers are from example-robot-data's
/// tiago.urdf, with exact right angles.
fpbm::Chain<> tiago_arm() {
  using namespace fpbm::presets::arms;
  const Vector<3> z(0.0, 0.0, 1.0);
  const auto within = [](double lower, double upper) { return fpbm::JointBounds<>{lower * kDegree, upper * kDegree}; };
  return chain_of(
      {
          {"arm_1_joint", {0.15505, 0.014, -0.151}, {0.0, 0.0, -kRight}, z, within(0.0, 157.5)},
          {"arm_2_joint", {0.125, 0.0165, -0.031}, {kRight, 0.0, 0.0}, z, within(-90.0, 62.5)},
          {"arm_3_joint", {0.0895, 0.0, 0.0015}, {-kRight, 0.0, kRight}, z, within(-202.5, 90.0)},
          {"arm_4_joint", {-0.02, -0.027, -0.222}, {-kRight, -kRight, 0.0}, z, within(-22.5, 135.0)},
          {"arm_5_joint", {-0.162, 0.02, 0.027}, {0.0, -kRight, 0.0}, z, within(-120.0, 120.0)},
          {"arm_6_joint", {0.0, 0.0, 0.15}, {0.0, -kRight, -kRight}, z, within(-81.0, 81.0)},
          {"arm_7_joint", {0.0, 0.0, 0.0}, {kRight, 0.0, kRight}, z, within(-120.0, 120.0)},
      },
      placed({0.0, 0.0, 0.046}, {kRight, -kRight, kHalfTurn}));
}

/// Left arm of a Unitree G1, from the torso to the palm.
fpbm::Chain<> g1_arm() {
  const auto tree = fpbm::presets::g1_upper_body();
  fpbm::Chain<> chain;
  for (std::size_t i = 3; i < 10; ++i) chain.joints.push_back(tree.joints[i].joint);
  chain.tip.p = {0.0415, 0.003, 0.0};
  return chain;
}

}  // namespace

int main(int argc, char** argv) {
  const int poses = argc > 1 ? std::atoi(argv[1]) : 10000;
  Arm<7>("panda", fpbm::presets::panda(), poses).print();
  Arm<7>("fr3", fpbm::presets::fr3(), poses).print();
  Arm<7>("iiwa14", fpbm::presets::iiwa14(), poses).print();
  Arm<7>("gen3", fpbm::presets::gen3(), poses).print();
  Arm<6>("ur5e", fpbm::presets::ur5e(), poses).print();
  Arm<7>("xarm7", fpbm::presets::xarm7(), poses).print();
  Arm<7>("tiago", tiago_arm(), poses).print();
  Arm<7>("g1", g1_arm(), poses).print();
}
