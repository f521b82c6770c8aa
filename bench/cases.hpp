#pragma once

#include <array>
#include <random>
#include <string>

#include "fpbm/fpbm.hpp"

// Arms, tasks, schemes and states of the benchmarks, for all libraries.
namespace bench {

/// Links of 1 m.
template <int N>
struct Planar {
  static constexpr int kDof = N;
  using Arm = fpbm::PlanarArm<N>;

  static std::string name() { return "planar" + std::to_string(N); }
  static Arm arm() { return Arm(fpbm::Vector<N>::Ones()); }
  static fpbm::Chain<> chain() {
    fpbm::Chain<> chain;
    chain.joints.resize(N);
    chain.tip.p(0) = 1.0;
    for (int i = 1; i < N; ++i) chain.joints[static_cast<std::size_t>(i)].placement = chain.tip;
    return chain;
  }
  static fpbm::Vector<N> bent() { return fpbm::Vector<N>::Constant(0.6); }
};

/// A spatial arm of seven joints, from the presets of the library.
template <fpbm::Chain<> (*preset)()>
struct Preset {
  static constexpr int kDof = 7;
  using Arm = fpbm::SerialArm<7>;

  static Arm arm() { return Arm(preset()); }
  static fpbm::Chain<> chain() { return preset(); }
  static fpbm::Vector<7> bent() { return (fpbm::Vector<7>() << 0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8).finished(); }
};
struct Panda : Preset<fpbm::presets::panda> {
  static std::string name() { return "panda"; }
};
struct Iiwa14 : Preset<fpbm::presets::iiwa14> {
  static std::string name() { return "iiwa14"; }
};

/// An arm with a task. If Scalar has several lanes, one arm in each lane.
template <typename Robot_, typename Space_, typename Scalar_ = double>
struct Case {
  using Robot = Robot_;
  using Space = Space_;
  using Scalar = Scalar_;
  static constexpr int kDof = Robot::kDof;
  static constexpr int kRows = Space::kRows;
  static constexpr bool kWithOrientation = std::is_same_v<Space, fpbm::Pose>;

  static std::string name() { return Robot::name() + (kWithOrientation ? "/pose" : "/position"); }
};
using PandaPose = Case<Panda, fpbm::Pose>;

/// Calls visit(case) for each case.
template <typename Visit>
void for_each_case(Visit visit) {
  visit(Case<Planar<4>, fpbm::Position<2>>{});
  visit(Case<Planar<7>, fpbm::Position<2>>{});
  visit(Case<Panda, fpbm::Position<3>>{});
  visit(PandaPose{});
  visit(Case<Iiwa14, fpbm::Position<3>>{});
  visit(Case<Iiwa14, fpbm::Pose>{});
}

enum class Law { kMVN, kWMVN, kMAN, kWMVNAcceleration, kBalanced, kFPBM };

template <Law law>
using LawConstant = std::integral_constant<Law, law>;

/// Calls visit(LawConstant) for each law.
template <typename Visit>
void for_each_law(Visit visit) {
  visit(LawConstant<Law::kMVN>{});
  visit(LawConstant<Law::kWMVN>{});
  visit(LawConstant<Law::kMAN>{});
  visit(LawConstant<Law::kWMVNAcceleration>{});
  visit(LawConstant<Law::kBalanced>{});
  visit(LawConstant<Law::kFPBM>{});
}

constexpr const char* name(Law law) {
  constexpr std::array kNames{"mvn", "wmvn", "man", "wmvn_acceleration", "balanced", "fpbm"};
  return kNames[static_cast<std::size_t>(law)];
}

constexpr bool is_acceleration(Law law) {
  return law != Law::kMVN && law != Law::kWMVN;
}

constexpr double kAlpha = 0.6;
constexpr double kGain = 10.0;  ///< Feedback gain at velocity level.
constexpr double kGain1 = 20.0;
constexpr double kGain2 = 100.0;

/// W = diag(1, 2, …, n), as in the paper.
template <int N>
fpbm::Vector<N> weights(Eigen::Index dof = N) {
  return fpbm::Vector<N>::LinSpaced(dof, 1.0, static_cast<double>(dof));
}

/// The scheme of this library.
template <Law law, int N, typename Scalar = double>
auto scheme(Eigen::Index dof = N) {
  const fpbm::DiagonalWeights<N, Scalar> W(weights<N>(dof).template cast<Scalar>());
  const Scalar alpha(kAlpha);
  const Scalar gain(kGain);
  if constexpr (law == Law::kMVN) return fpbm::MVN<N, Scalar>(gain);
  if constexpr (law == Law::kWMVN) return fpbm::WMVN<N, Scalar>(W, gain);
  if constexpr (law == Law::kMAN) return fpbm::MAN<N, Scalar>();
  if constexpr (law == Law::kWMVNAcceleration) return fpbm::WMVNAcceleration<N, Scalar>(W);
  if constexpr (law == Law::kBalanced) return fpbm::Balanced<N, Scalar>(alpha, W);
  if constexpr (law == Law::kFPBM) return fpbm::FPBM<N, Scalar>(alpha, W, Scalar(kGain1), Scalar(kGain2));
}

template <typename Space, int N, typename Scalar = double>
struct Input {
  fpbm::State<N, Scalar> state;
  fpbm::Reference<Space, Scalar> reference;
};

/// Random states around a bent posture, within ±scatter [rad], that satisfy `accepted`, and references near the tip.
/// The states are the same in every run. The states fit into the first-level cache, and are so many that the compiler
/// cannot hoist computations out of the loop.
template <typename Space, typename Arm, typename Accepted, int N = Arm::kDof>
auto inputs(const Arm& arm, const fpbm::Vector<N>& bent, double scatter, Accepted accepted) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto fill = [&](auto vector, double reach) {
    for (double& value : vector) value = reach * uniform(generator);
    return vector;
  };
  const fpbm::Vector<Space::kRows> zero = fpbm::Vector<Space::kRows>::Zero();
  std::array<Input<Space, N>, 64> result;
  for (auto& [state, reference] : result) {
    fpbm::Kinematics<Space, N> kinematics;
    do {
      state = {bent + fill(bent, scatter), fill(bent, 1.0)};
      arm.kinematics(state.q, kinematics);
    } while (!accepted(kinematics));
    reference.x = Space::template displace<double>(kinematics.tip, fill(zero, 0.01));
    reference.xd = fill(zero, 0.5);
    reference.xdd = fill(zero, 0.5);
  }
  return result;
}

/// Far from singular postures.
template <typename Case>
auto inputs(Case) {
  const auto any = [](const auto&) { return true; };
  return inputs<typename Case::Space>(Case::Robot::arm(), Case::Robot::bent(), 0.45, any);
}

/// The case in postures with active damping.
template <typename Case>
struct NearSingular : Case {};

template <typename Case>
auto inputs(NearSingular<Case>) {
  const auto is_near = [](const auto& kinematics) {
    const auto J = jacobian_in_metres(kinematics);
    return fpbm::least_singular_value_bound(J) < 0.5 * fpbm::SingularDamping<>().radius() * J.norm();
  };
  return inputs<typename Case::Space>(Case::Robot::arm(), Case::Robot::bent(), 3.0, is_near);
}

}  // namespace bench
