#pragma once

#include <cstddef>
#include <string>

#include "ours.hpp"

// Jobs that are timed and counted: each call of a job uses the next state of its ring.
namespace bench {

/// Prevents optimisation: the compiler must assume that the object is read and changed.
template <typename T>
void escape(T& object) noexcept {
  asm volatile("" : : "g"(&object) : "memory");
}

/// An empty job: the overhead of timing and counting.
struct Nothing {
  void operator()() noexcept { escape(*this); }
};

/// The states of a case in a ring.
template <typename Case>
class Ring {
 public:
  using Inputs = decltype(inputs(Case{}));

  explicit Ring(const Inputs& given = inputs(Case{})) : inputs_(given) {}

  const auto& next() noexcept { return inputs_[++turn_ % inputs_.size()]; }

 private:
  Inputs inputs_;
  std::size_t turn_ = 0;
};

/// Kinematics alone: tip and J, and Jd if the scheme needs it.
template <typename Solver>
class Move {
 public:
  void operator()() noexcept {
    solver_.move(ring_.next());
    escape(solver_);
  }

 private:
  Solver solver_;
  Ring<typename Solver::Case> ring_;
};

/// One evaluation of the closed loop: kinematics and scheme.
template <typename Solver>
class Step {
 public:
  void operator()() noexcept {
    const auto& input = ring_.next();
    solver_.move(input);
    status_ = solver_.resolve(input, out_);
    escape(*this);
  }

 private:
  Solver solver_;
  Ring<typename Solver::Case> ring_;
  fpbm::Vector<Solver::Case::kDof, typename Solver::Case::Scalar> out_;
  fpbm::Status status_;
};

/// The scheme alone, with precomputed kinematics of each state. Few states, because J and Jd of all states would not
/// fit into the first-level cache.
template <typename Solver>
class Resolve {
 public:
  Resolve() {
    const auto all = inputs(Case{});
    for (std::size_t i = 0; i < given_.size(); ++i) {
      solver_.move(all[i]);
      given_[i] = {all[i], solver_.kinematics()};
    }
  }

  void operator()() noexcept {
    const auto& [input, kinematics] = given_[++turn_ % given_.size()];
    status_ = solver_.resolve(kinematics, input, out_);
    escape(*this);
  }

 private:
  using Case = typename Solver::Case;
  struct Given {
    Input<typename Case::Space, Case::kDof, typename Case::Scalar> input;
    fpbm::Kinematics<typename Case::Space, Case::kDof, typename Case::Scalar> kinematics;
  };

  Solver solver_;
  std::array<Given, 16> given_;
  std::size_t turn_ = 0;
  fpbm::Vector<Case::kDof, typename Case::Scalar> out_;
  fpbm::Status status_;
};

/// One RK4 step of 1 ms along the paper's circle, as in rollout(). Time continues from call to call.
template <int N, Law law>
class Rk4Step {
 public:
  void operator()() noexcept {
    const auto& state = ring_.next().state;
    X x(N, Loop::kSecondOrder ? 2 : 1);
    x.col(0) = state.q;
    if constexpr (Loop::kSecondOrder) x.col(1) = state.qd;
    const auto derivative = [this](double t, const X& at, X& dx) noexcept {
      return loop_.evaluate(references_.motion(t, t), at, dx);
    };
    status_ = fpbm::RK4::step(derivative, kDt * count_, kDt, x);
    count_ = (count_ + 1) % kSteps;
    escape(x);
    escape(*this);
  }

 private:
  using Arm = fpbm::PlanarArm<N>;
  using Space = fpbm::Position<2>;
  using Loop = fpbm::ClosedLoop<Arm, decltype(scheme<law, N>()), Space>;
  using X = typename Loop::X;
  using Path = decltype(fpbm::Path(fpbm::Circle(0.45), 1.0));
  static constexpr double kDt = 1e-3;
  static constexpr int kSteps = 10000;

  static fpbm::Kinematics<Space, N> start(const fpbm::State<N>& state) {
    fpbm::Kinematics<Space, N> kinematics;
    Planar<N>::arm().kinematics(state.q, state.qd, kinematics);
    return kinematics;
  }

  Arm arm_ = Planar<N>::arm();
  decltype(scheme<law, N>()) scheme_ = scheme<law, N>();
  Path path_{fpbm::Circle(0.45), kDt* kSteps};
  Ring<Case<Planar<N>, Space>> ring_;
  fpbm::State<N> first_ = ring_.next().state;
  Loop loop_{arm_, scheme_, start(first_), first_, first_.qd};
  fpbm::AnchoredPath<Path> references_{path_, start(first_).tip};
  int count_ = 0;
  fpbm::Status status_;
};

/// A scheme for a Panda within its limits.
inline auto damped() {
  auto fpbm = scheme<Law::kFPBM, 7>();
  fpbm.null_space = fpbm::NullSpace<7>().with_damping(2.0);
  return fpbm;
}
template <typename Space, bool kJerk>
auto tracker() {
  auto chain = Panda::chain();
  for (auto& joint : chain.joints) {
    if (!kJerk) joint.bounds.jerk = fpbm::JointBounds<>::kNone;
  }
  return fpbm::Tracker(fpbm::SerialArm<7>(chain), Space{}, damped(), Panda::bent());
}

/// Slow states, and references at rest near the tip, so that the limits are not active.
inline auto calm() {
  auto result = inputs(PandaPose{});
  for (auto& [state, reference] : result) {
    state.qd *= 0.1;
    reference = fpbm::Reference<fpbm::Pose>::hold(reference.x);
  }
  return result;
}

/// A tick of 1 ms from the tracker's own state.
template <bool kJerk>
class Tick {
 public:
  void operator()() noexcept {
    auto result = loop_.tick(home_);
    escape(result);
    escape(*this);
  }

 private:
  decltype(tracker<fpbm::Pose, kJerk>()) loop_ = tracker<fpbm::Pose, kJerk>();
  fpbm::Reference<fpbm::Pose> home_ = fpbm::Reference<fpbm::Pose>::hold(loop_.tip());
};

/// A tick of a tracker with active limits: its target jumps every 64 ticks.
template <typename Space, bool kJerk>
class LimitedTick {
 public:
  void operator()() noexcept {
    if (turn_++ % 64 == 0) target_ = fpbm::Reference<Space>::hold(ring_.next().reference.x);
    auto result = loop_.tick(target_);
    escape(result);
    escape(*this);
  }

 private:
  decltype(tracker<Space, kJerk>()) loop_ = tracker<Space, kJerk>();
  Ring<Case<Panda, Space>> ring_;
  fpbm::Reference<Space> target_;
  int turn_ = 0;
};

/// A Panda among a table, a box, walls and posts, with at least 20 pairs closer than 15 cm.
inline fpbm::Clearance<7> surroundings() {
  using Vector3 = fpbm::Vector<3>;
  const auto post = [](double x, double y) { return fpbm::Capsule<>{{x, y, 0.2}, {x, y, 1.0}, 0.03}; };
  const std::vector<fpbm::Obstacle<>> obstacles = {
      {"table", fpbm::HalfSpace<>{Vector3::UnitZ(), -0.02}},
      {"left", fpbm::HalfSpace<>{-Vector3::UnitY(), -0.22}},
      {"right", fpbm::HalfSpace<>{Vector3::UnitY(), -0.22}},
      {"back", fpbm::Cuboid<>{{Vector3(-0.32, 0.0, 0.5), fpbm::Matrix<3, 3>::Identity()}, Vector3(0.1, 0.3, 0.5)}},
      {"post 1", post(0.35, 0.17)},
      {"post 2", post(0.35, -0.17)},
      {"lid", fpbm::Cuboid<>{{Vector3(0.2, 0.0, 1.05), fpbm::Matrix<3, 3>::Identity()}, Vector3(0.4, 0.3, 0.05)}}};
  fpbm::Clearance<7> clearance(Panda::chain(), fpbm::presets::capsules::panda(), obstacles, 0.005,
                               fpbm::presets::never_collide::panda());
  return clearance;
}

/// Number of pairs of surroundings() that are closer than 15 cm in the bent posture.
inline int near_pairs() {
  const auto clearance = surroundings();
  auto placed = clearance.placement();
  clearance.place(Panda::bent(), placed);
  int count = 0;
  for (const auto& pair : clearance.pairs()) count += clearance.nearest_of(placed, pair).distance < 0.15;
  return count;
}

/// Torques of a Panda within a fraction of its efforts, with a load [kg] 15 cm beyond the flange.
inline fpbm::TorqueBounds<7> torques(double fraction, double load) {
  const auto chain = Panda::chain();
  fpbm::Dynamics<7> model(chain);
  fpbm::LinkInertia<> body;
  body.mass = load;
  body.centre = {0.0, 0.0, 0.15};
  model.set_payload(fpbm::Robot<7>::kTip, body);
  return {chain, model, fraction * fpbm::SerialArm<7>(chain).limits().effort};
}

/// A tick of a motion that swings by 10 cm, with and without a clearance.
template <typename Bounds>
class SwingingTick {
 public:
  void operator()() noexcept {
    const double t = 1e-3 * (turn_++ % 6283);
    auto target = fpbm::Reference<fpbm::Pose>::hold(home_);
    target.x.p(1) += 0.05 * std::sin(t);
    target.xd(1) = 0.05 * std::cos(t);
    target.xdd(1) = -0.05 * std::sin(t);
    auto result = loop_.tick(target);
    escape(result);
    escape(*this);
  }

 private:
  static auto make() {
    const fpbm::SerialArm<7> arm(Panda::chain());
    const fpbm::State<7> start{Panda::bent(), fpbm::Vector<7>::Zero()};
    const fpbm::Limits<fpbm::Level::kAcceleration, 7> limits(arm.limits(), 1e-3);
    using Loop = fpbm::Tracker<fpbm::SerialArm<7>, fpbm::Pose, decltype(damped()), Bounds>;
    if constexpr (std::is_same_v<Bounds, fpbm::Bounds<>>) {
      return Loop(arm, fpbm::Pose{}, damped(), start, {}, limits);
    } else if constexpr (std::is_same_v<Bounds, fpbm::Bounds<fpbm::Clearance<7>>>) {
      return Loop(arm, fpbm::Pose{}, damped(), start, {}, limits, fpbm::Vector<7>::Zero(), Bounds(surroundings()));
    } else {
      return Loop(arm, fpbm::Pose{}, damped(), start, {}, limits, fpbm::Vector<7>::Zero(), Bounds(torques(1.0, 0.0)));
    }
  }

  decltype(make()) loop_ = make();
  fpbm::Transform<> home_ = loop_.tip();
  int turn_ = 0;
};
using FreeTick = SwingingTick<fpbm::Bounds<>>;
using ClearTick = SwingingTick<fpbm::Bounds<fpbm::Clearance<7>>>;
using FreeTorqueTick = SwingingTick<fpbm::Bounds<fpbm::TorqueBounds<7>>>;

/// Tracker of postures of a Panda with 1.5 kg at 60 % of its efforts.
inline auto loaded() {
  const fpbm::Robot<7> robot(Panda::chain());
  const fpbm::State<7> start{{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.8}, fpbm::Vector<7>::Zero()};
  const fpbm::Limits<fpbm::Level::kAcceleration, 7> limits(fpbm::SerialArm<7>(Panda::chain()).limits(), 1e-3);
  const auto law = fpbm::Balanced<7>(0.0, fpbm::UnitWeights{}, fpbm::NullSpace<7>().with_damping(2.0));
  return fpbm::stack_tracker(robot, fpbm::Stack(fpbm::PostureTask<7>{fpbm::TaskGains<>(12.0, 36.0)}), law, start, {},
                             limits, fpbm::Vector<7>(fpbm::Vector<7>::Zero()), fpbm::Bounds(torques(0.6, 1.5)));
}

/// A tick of loaded(), whose target posture jumps every 2,000 ticks: every 97th tick, unless the arm is at rest.
class TorqueTick {
 public:
  TorqueTick() {
    auto loop = loaded();
    fpbm::Reference<fpbm::JointSpace<7>> target;
    for (int turn = 0; loops_.size() < 128; ++turn) {
      if (turn % 2000 == 0) target = fpbm::Reference<fpbm::JointSpace<7>>::hold(next_target());
      if (turn % 97 == 0 && loop.state().qd.norm() > 0.01) loops_.emplace_back(loop, target);
      loop.tick(target);
    }
  }
  void operator()() noexcept {
    auto& [loop, target] = loops_[turn_++ % loops_.size()];
    auto result = loop.tick(target);
    escape(result);
    escape(*this);
  }

 private:
  /// A random posture that the torques hold.
  fpbm::Vector<7> next_target() {
    const auto limits = fpbm::SerialArm<7>(Panda::chain()).limits();
    const auto bounds = torques(0.5, 1.5);
    for (;;) {
      fpbm::Vector<7> q;
      for (int i = 0; i < 7; ++i) {
        q(i) = std::uniform_real_distribution<>(limits.lower(i) + 0.15, limits.upper(i) - 0.15)(random_);
      }
      fpbm::Dynamics<7>::State state;
      bounds.model().robot().update(q, state);
      const fpbm::Vector<7> torque = bounds.model().gravity_torque(state);
      if ((torque.cwiseAbs().array() <= bounds.effort().array()).all()) return q;
    }
  }

  std::mt19937 random_{1};
  std::vector<std::pair<decltype(loaded()), fpbm::Reference<fpbm::JointSpace<7>>>> loops_;
  std::size_t turn_ = 0;
};

/// The result for a measured state, without bounds on jerk, because consecutive states are unrelated.
class Measured {
 public:
  void operator()() noexcept {
    const auto& input = ring_.next();
    auto result = loop_.resolve_measured(input.state.q, input.state.qd, input.reference);
    escape(result);
    escape(*this);
  }

 private:
  decltype(tracker<fpbm::Pose, false>()) loop_ = tracker<fpbm::Pose, false>();
  Ring<PandaPose> ring_{calm()};
};

}  // namespace bench
