#pragma once

#include <string>
#include <tuple>

#include "cases.hpp"

// Stacks of three levels on a Panda at 1 kHz: the tip on a moving target, the elbow (origin of joint 4), a posture.
// Bounds on position, velocity and acceleration. A solver is a function of Asked that writes joint accelerations.
namespace bench::stack {

constexpr int N = 7;
constexpr int kElbow = 4;
constexpr double kTick = 1e-3;
constexpr double kK1 = 20.0;   ///< For tip and elbow [1/s].
constexpr double kK2 = 100.0;  ///< [1/s²]
constexpr double kPosture1 = 4.0;
constexpr double kPosture2 = 4.0;
using Joints = fpbm::Vector<N>;

inline const Joints kStart = (Joints() << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785).finished();

inline fpbm::TaskGains<> gains() {
  return {kK1, kK2};
}

/// Pose of the tip, position of the elbow, posture: tip and elbow determine the motion.
struct TipPose {
  static constexpr int kRows = 6;
  static constexpr int kElbowRows = 3;
  static constexpr int kElbowRank = 1;  ///< Rows of the elbow in the null space of the tip.
  static std::string name() { return "pose"; }
  static auto stack() {
    return fpbm::Stack(fpbm::PoseTask<>{{fpbm::Robot<N>::kTip}, gains()},
                       fpbm::PositionTask<3>{{kElbow}, gains(), {0, 1, 2}},
                       fpbm::PostureTask<N>{fpbm::TaskGains<>(kPosture1, kPosture2)});
  }
};

/// Position of the tip, height of the elbow, posture: each level has degrees of freedom of its own.
struct TipPosition {
  static constexpr int kRows = 3;
  static constexpr int kElbowRows = 1;
  static constexpr int kElbowRank = 1;
  static std::string name() { return "position"; }
  static auto stack() {
    return fpbm::Stack(fpbm::PositionTask<3>{{fpbm::Robot<N>::kTip}, gains(), {0, 1, 2}},
                       fpbm::PositionTask<1>{{kElbow}, gains(), {2}},
                       fpbm::PostureTask<N>{fpbm::TaskGains<>(kPosture1, kPosture2)});
  }
};

template <typename Case>
using StackOf = decltype(Case::stack());
template <typename Case>
using SpaceOf = typename StackOf<Case>::Space;

template <typename Case>
struct Asked {
  fpbm::State<N> state;
  Joints last;  ///< Acceleration of the last tick.
  fpbm::Reference<SpaceOf<Case>> reference;
};

using Limits = fpbm::Limits<fpbm::Level::kAcceleration, N>;

inline fpbm::Chain<> chain() {
  fpbm::Chain<> chain = fpbm::presets::panda();
  for (auto& joint : chain.joints) joint.bounds.jerk = fpbm::JointBounds<>::kNone;
  return chain;
}
inline Limits limits() {
  return {fpbm::Robot<N>(chain()).limits(), kTick};
}

/// A limited step of this library: kinematics, law and saturation, as in a tick of a tracker.
template <typename Case>
class Ours {
 public:
  static std::string name() { return "fpbm_cpp"; }

  Ours() { give_damping(scheme_, fpbm::TrackerOptions<>().damping(N, Case::kRows)); }

  [[gnu::noinline]] void operator()(const Asked<Case>& asked, Joints& u) {
    resolve(asked);
    const auto found = limiter_.motion(jacobian_in_metres(kinematics_), asked.state, desired_, asked.last);
    u = found.u;
    scale_ = found.scale;
  }

  /// Kinematics and law alone.
  [[gnu::noinline]] void resolve(const Asked<Case>& asked) {
    tasks_.kinematics(asked.state.q, asked.state.qd, kinematics_);
    status_ = scheme_.resolve(kinematics_, asked.reference, asked.state, desired_);
  }

  [[nodiscard]] bool is_free(const Asked<Case>& asked) {
    resolve(asked);
    return limiter_.limits().box(asked.state).contains(desired_);
  }

  [[nodiscard]] const auto& kinematics() const noexcept { return kinematics_; }
  [[nodiscard]] const Joints& desired() const noexcept { return desired_; }
  [[nodiscard]] double scale() const noexcept { return scale_; }
  [[nodiscard]] fpbm::Status status() const noexcept { return status_; }
  /// J of level 0, with rotations in metres.
  [[nodiscard]] const auto& first_rows() const noexcept { return std::get<0>(kinematics_.levels).J; }

 private:
  using Scheme = decltype(fpbm::Balanced<N>(kAlpha, fpbm::UnitWeights{}));
  using Stack = StackOf<Case>;

  fpbm::RobotTasks<fpbm::Robot<N>, Stack> tasks_{fpbm::Robot<N>(chain()), Case::stack()};
  fpbm::ByLevels<Scheme, Stack> scheme_{fpbm::Balanced<N>(kAlpha, fpbm::UnitWeights{})};
  fpbm::Limiter<fpbm::Level::kAcceleration, N> limiter_{limits()};
  fpbm::Kinematics<SpaceOf<Case>, N> kinematics_;
  Joints desired_ = Joints::Zero();
  double scale_ = 1.0;
  fpbm::Status status_ = fpbm::Status::kOk;
};

}  // namespace bench::stack
