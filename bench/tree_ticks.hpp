#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "g1_upper_body.hpp"
#include "jobs.hpp"

// Ticks of stacks on robots with several arms: rows ticks/robot/stack/limited or free. A target swings. The counter
// `limited` is the fraction of ticks with active bounds.
namespace bench {

/// Arms of 7 joints, all Pandas, side by side or on a torso that rotates and leans.
template <int Arms, int Torso>
struct Pandas {
  static constexpr int kDof = 7 * Arms + Torso;
  static std::string name() { return std::to_string(kDof); }
  static fpbm::Tree<> tree() {
    fpbm::Tree<> tree;
    int chest = 0;
    if constexpr (Torso > 0) {
      fpbm::Chain<> torso;
      torso.joints.resize(Torso);
      for (int i = 0; i < Torso; ++i) {
        auto& joint = torso.joints[static_cast<std::size_t>(i)];
        joint.axis = fpbm::Vector<3>::Unit((i + 2) % 3);
        joint.placement.p(2) = 0.2;
        joint.bounds = {-1.0, 1.0, 1.5, 7.5, 3750.0};
      }
      chest = fpbm::add_arm(tree, torso, "torso");
    }
    for (int i = 0; i < Arms; ++i) {
      fpbm::Transform<> place;
      place.p(1) = 0.8 * i;
      fpbm::add_arm(tree, fpbm::presets::panda(), "arm" + std::to_string(i), chest, place);
    }
    return tree;
  }
  static fpbm::Vector<kDof> start() {
    fpbm::Vector<kDof> q = fpbm::Vector<kDof>::Zero();
    const fpbm::Vector<7> home{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785};
    for (int i = 0; i < Arms; ++i) q.template segment<7>(Torso + 7 * i) = home;
    return q;
  }
  static fpbm::LinkFrame<> first() { return {Torso + 7, fpbm::presets::panda().tip}; }
  static fpbm::LinkFrame<> last() { return {kDof, fpbm::presets::panda().tip}; }
};

/// The upper body of the G1, with bounds on accelerations and jerks, which its URDF file does not have.
struct UpperBodyInMotion {
  static constexpr int kDof = 17;
  static std::string name() { return "g1_upper_body"; }
  static fpbm::Tree<> tree() {
    fpbm::Tree<> tree = g1_upper_body();
    for (auto& [joint, parent] : tree.joints) {
      joint.bounds.velocity = 3.0;
      joint.bounds.acceleration = 15.0;
      joint.bounds.jerk = 5000.0;
    }
    return tree;
  }
  static fpbm::Vector<kDof> start() {
    fpbm::Vector<kDof> q = fpbm::Vector<kDof>::Zero();
    for (int arm = 0; arm < 2; ++arm) {
      q.segment<4>(3 + 7 * arm) = fpbm::Vector<4>{0.2, arm == 0 ? 0.3 : -0.3, 0.0, 0.9};
    }
    return q;
  }
  static fpbm::LinkFrame<> first() { return fpbm::frame_of(tree(), "left_hand"); }
  static fpbm::LinkFrame<> last() { return fpbm::frame_of(tree(), "right_hand"); }
};

/// Pose of the first hand; position of a joint of the last arm; axis of the hand of this arm; posture. With fewer
/// levels, the levels in between are omitted first.
template <typename Case, int Levels>
auto growing_stack() {
  const fpbm::TaskGains<> gains(10.0, 25.0);
  const fpbm::PoseTask<> hand{Case::first(), gains};
  const fpbm::PositionTask<3> elbow{{Case::kDof - 3}, gains};
  const fpbm::AxisTask<> axis(Case::last(), gains);
  const fpbm::PostureTask<Case::kDof> posture{fpbm::TaskGains<>(4.0, 4.0)};
  if constexpr (Levels == 1) return fpbm::Stack(hand);
  if constexpr (Levels == 2) return fpbm::Stack(hand, posture);
  if constexpr (Levels == 3) return fpbm::Stack(hand, elbow, posture);
  if constexpr (Levels == 4) return fpbm::Stack(hand, elbow, axis, posture);
}

/// Poses of both hands on one level.
template <typename Case>
auto two_poses() {
  const fpbm::TaskGains<> gains(10.0, 25.0);
  return fpbm::Stack(fpbm::TaskLevel(fpbm::PoseTask<>{Case::first(), gains}, fpbm::PoseTask<>{Case::last(), gains}));
}

/// A grasp, the pose of the object, a posture.
template <typename Case>
auto grasp() {
  return fpbm::Stack(fpbm::RelativePoseTask<>{{Case::last(), {400.0, 40000.0}}, Case::first()},
                     fpbm::PoseTask<>{Case::first(), {10.0, 25.0}},
                     fpbm::PostureTask<Case::kDof>{fpbm::TaskGains<>(4.0, 4.0)});
}

/// Ticks in which the target of pose kMoved swings. kLimited: whether bounds are active.
template <typename Case, bool kLimited, int kMoved, typename MakeStack>
void run_ticks(benchmark::State& bench, MakeStack make_stack) {
  constexpr int N = Case::kDof;
  const fpbm::Robot<N> robot(Case::tree());
  const auto scheme = fpbm::Balanced<N>(0.0, fpbm::UnitWeights{}, fpbm::NullSpace<N>().with_damping(2.0));
  const fpbm::State<N> start{Case::start(), fpbm::Vector<N>(fpbm::Vector<N>::Zero())};
  const auto limits = kLimited ? robot.limits() : fpbm::JointLimits<N>::none(N);
  auto tracker = fpbm::stack_tracker(robot, make_stack(), scheme, start, fpbm::TrackerOptions<>{},
                                     fpbm::Limits<fpbm::Level::kAcceleration, N>(limits, 1e-3));
  auto target = decltype(tracker)::Target::hold(tracker.tip());
  const fpbm::Vector<3> centre = std::get<kMoved>(target.x).p;
  const fpbm::Vector<3> rates = (kLimited ? 6.0 : 2.0) * fpbm::Vector<3>(1.0, 0.7, 1.3);  // [rad/s]
  const double size = kLimited ? 0.3 : 0.05;                                              // [m]
  long ticks = 0;
  double limited = 0;
  for (auto _ : bench) {
    const double t = 1e-3 * static_cast<double>(++ticks);
    for (int i = 0; i < 3; ++i) {
      const double sine = size * std::sin(rates(i) * t);
      std::get<kMoved>(target.x).p(i) = centre(i) + sine;
      target.xd(6 * kMoved + i) = size * rates(i) * std::cos(rates(i) * t);
      target.xdd(6 * kMoved + i) = -rates(i) * rates(i) * sine;
    }
    auto tick = tracker.tick(target);
    escape(tick);
    limited += tick.saturated != 0 ? 1.0 : 0.0;
  }
  bench.counters["limited"] = limited / static_cast<double>(ticks);
}

template <typename Case, bool kLimited, int kMoved, typename MakeStack>
void add_ticks(const std::string& stack, MakeStack make_stack) {
  const std::string name = "ticks/" + Case::name() + "/" + stack + (kLimited ? "/limited" : "/free");
  benchmark::RegisterBenchmark(
      name.c_str(), [make_stack](benchmark::State& bench) { run_ticks<Case, kLimited, kMoved>(bench, make_stack); });
}

/// One to four levels.
template <typename Case>
bool add_growing_ticks() {
  add_ticks<Case, true, 0>("1", growing_stack<Case, 1>);
  add_ticks<Case, true, 0>("2", growing_stack<Case, 2>);
  add_ticks<Case, true, 0>("3", growing_stack<Case, 3>);
  add_ticks<Case, true, 0>("4", growing_stack<Case, 4>);
  return true;
}

}  // namespace bench
