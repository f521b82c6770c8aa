#pragma once

#include "jobs.hpp"

// A UR5e welds with a torch that is free to rotate about its axis: position and axis of the tip on one level, 5 rows.
namespace bench {

inline auto torch_stack() {
  const fpbm::LinkFrame<> tip(fpbm::Robot<6>::kTip);
  const fpbm::TaskGains<> gains(kGain1, kGain2);
  return fpbm::Stack(fpbm::TaskLevel(fpbm::PositionTask<>{tip, gains}, fpbm::AxisTask<>(tip, gains)));
}
/// The tasks include the feedback.
inline auto torch_scheme() {
  auto scheme = fpbm::Balanced<6>(kAlpha, fpbm::DiagonalWeights<6>(weights<6>()));
  scheme.singular = fpbm::SingularDamping<>();
  return scheme;
}

struct Torch {
  static constexpr int kDof = 6;
  using Scalar = double;
  using Stack = decltype(torch_stack());
  using Space = Stack::Space;
  using Tasks = fpbm::RobotTasks<fpbm::Robot<kDof>, Stack>;
  static Tasks arm() { return {fpbm::Robot<kDof>(fpbm::presets::ur5e()), torch_stack()}; }
  static fpbm::Vector<kDof> bent() { return (fpbm::Vector<kDof>() << 0.0, -1.2, 1.8, -2.2, -1.5, 0.3).finished(); }
};

inline auto inputs(Torch) {
  return inputs<Torch::Space>(Torch::arm(), Torch::bent(), 0.45, [](const auto&) { return true; });
}

/// FPBM with damping enabled, for jobs.hpp.
class TorchSolver {
 public:
  using Case = Torch;

  void move(const Input<Torch::Space, Torch::kDof>& input) noexcept {
    arm_.kinematics(input.state.q, input.state.qd, kinematics_);
  }
  fpbm::Status resolve(const Input<Torch::Space, Torch::kDof>& input, fpbm::Vector<Torch::kDof>& out) const noexcept {
    return scheme_.resolve(kinematics_, input.reference, input.state, out);
  }

 private:
  Torch::Tasks arm_ = Torch::arm();
  fpbm::ByLevels<decltype(torch_scheme()), Torch::Stack> scheme_{torch_scheme()};
  fpbm::Kinematics<Torch::Space, Torch::kDof> kinematics_;
};

}  // namespace bench
