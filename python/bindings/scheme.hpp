#pragma once

#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "arm.hpp"
#include "fpbm/any/any_scheme.hpp"
#include "fpbm/any/detail/any_weights.hpp"
#include "fpbm/model/dynamics.hpp"
#include "fpbm/scheme/acceleration_scheme.hpp"
#include "fpbm/scheme/detail/minimum_energy.hpp"
#include "fpbm/scheme/detail/minimum_torque.hpp"
#include "fpbm/scheme/velocity_scheme.hpp"

namespace fpbm::bindings {

/// A scheme at velocity level or at acceleration level.
template <typename Space>
using EitherScheme = std::variant<AnyScheme<Level::kVelocity, Space>, AnyScheme<Level::kAcceleration, Space>>;

/// Dynamics that the copies of a scheme share.
struct SharedDynamics {
  using Scalar = double;
  using State = AnyDynamics::State;
  static constexpr int kDof = kDynamic;

  std::shared_ptr<const AnyDynamics> held;

  [[nodiscard]] const auto& robot() const noexcept { return held->robot(); }
  [[nodiscard]] int dof() const noexcept { return held->dof(); }
  [[nodiscard]] auto mass_matrix(const State& state) const noexcept { return held->mass_matrix(state); }
  [[nodiscard]] auto bias(const State& state) const noexcept { return held->bias(state); }
};

using LeastTorque = MinimumTorqueScheme<SharedDynamics, AnyWeights>;
using LeastEnergy = MinimumEnergyScheme<SharedDynamics>;
/// law.resolve_rows(), compiled once, in scheme.cpp.
[[nodiscard]] Status resolve_rows(const LeastTorque& law, const TaskEquation<kDynamic, kDynamic>& task,
                                  const State<kDynamic>& state, JointVector& u) noexcept;
[[nodiscard]] Status resolve_rows(const LeastEnergy& law, const TaskEquation<kDynamic, kDynamic>& task,
                                  const State<kDynamic>& state, JointVector& u) noexcept;

/// A law with dynamics, for all task spaces and stacks by the same resolve_rows().
template <typename Law>
struct WithDynamics {
  static constexpr Level kLevel = Law::kLevel;
  static constexpr int kDof = kDynamic;

  Law scheme;

  void require_dof(Eigen::Index dof) const { scheme.require_dof(dof); }

  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, kDynamic>& kinematics, const Reference<Space>& reference,
                               const State<kDynamic>& state, JointVector& u) const noexcept {
    const auto in_metres = [&](Matrix<kDynamic, kDynamic> rows) noexcept {
      for (int i = Space::kRows - Space::kTurns; i < Space::kRows; ++i) {
        for (Eigen::Index j = 0; j < rows.cols(); ++j) rows(i, j) *= kinematics.length;
      }
      return rows;
    };
    const auto command = [&] {
      if constexpr (kLevel == Level::kVelocity) return commanded_velocity(scheme.k, kinematics, reference);
      if constexpr (kLevel == Level::kAcceleration) {
        return commanded_acceleration(scheme.k1, scheme.k2, kinematics, reference, state);
      }
    }();
    const auto J = in_metres(kinematics.J), Jd = kLevel == Level::kVelocity ? J : in_metres(kinematics.Jd);
    const JointVector b = in_metres(command), xd = in_metres(reference.xd);
    return bindings::resolve_rows(scheme, {J, Jd, b, xd}, state, u);
  }
};

struct Scheme;
/// The weights of a scheme as one type. Throws std::invalid_argument if the number of weights is not dof.
AnyWeights any_weights(const Scheme& scheme, Eigen::Index dof);

/// The parameters of a scheme, before the number of joints is known. The default of a parameter has no effect.
struct Scheme {
  using Diagonal = Vector<kDynamic>;
  using Dense = Matrix<kDynamic, kDynamic>;

  Level level;
  std::variant<std::monostate, Diagonal, Dense> weights = {};  ///< None: W = I.
  double alpha = 0.0;
  double k = 0.0;
  double k1 = 0.0;
  double k2 = 0.0;
  double null_damping = 0.0;
  double null_stiffness = 0.0;
  std::optional<JointVector> rest_posture = {};
  std::optional<JointVector> c = {};
  double joint_centring = 0.0;
  double manipulability_gain = 0.0;
  SingularDamping<> singular = SingularDamping<>::off();
  bool uses_dynamics = false;  ///< Least energy at velocity level, least torque at acceleration level.
  std::shared_ptr<const AnyDynamics> dynamics = {};  ///< Set by on(), if uses_dynamics.

  /// The scheme for a robot, whose dynamics it has if uses_dynamics. Throws std::invalid_argument if then a drive of
  /// the robot moves no mass.
  [[nodiscard]] Scheme on(const Model& model) const;

  /// The scheme with the null-space damping of a tracker, if it has none.
  [[nodiscard]] Scheme with_null_damping(double damping) const {
    Scheme damped = *this;
    if (level == Level::kAcceleration && null_damping == 0.0) damped.null_damping = damping;
    damped.kept_ = {};
    return damped;
  }

  /// The scheme for an arm, with all objectives. Throws std::invalid_argument if a parameter is out of range or does
  /// not fit the arm.
  template <typename Space>
  [[nodiscard]] EitherScheme<Space> make(const AnyArmFor<Space>& arm) const;

  /// The scheme for that many joints, without an arm, made once, because the construction takes longer than a call of
  /// resolve(). continuous: bits of the continuous joints. Throws std::invalid_argument as make() does, and if an
  /// objective needs an arm.
  template <typename Space>
  [[nodiscard]] const EitherScheme<Space>& kept(Eigen::Index dof, JointBits continuous = 0) const {
    auto& [joints, turning, scheme] = std::get<Kept<Space>>(kept_);  // The caller holds Python's lock.
    if (!scheme || joints != dof || turning != continuous) {
      if (needs_arm())
        validation::reject("scheme", ": has dynamics or objectives that need an arm: give an arm, not a Kinematics");
      auto limits = JointLimits<kDynamic>::none(dof);
      limits.continuous = continuous;
      scheme = std::make_shared<const EitherScheme<Space>>(plain<Space>(limits));
      joints = dof;
      turning = continuous;
    }
    return *scheme;
  }

  /// Whether law() is the whole scheme: no objective wraps the law, and the law has no dynamics.
  [[nodiscard]] bool is_plain() const noexcept { return manipulability_gain == 0.0 && !uses_dynamics; }

  /// Whether the scheme reads the arm or its limits.
  [[nodiscard]] bool needs_arm() const noexcept { return !is_plain() || joint_centring != 0.0; }

  /// The scheme without objectives that wrap the law, for joints with the given limits. Compiled once, in scheme.cpp.
  template <typename Space>
  [[nodiscard]] EitherScheme<Space> plain(const JointLimits<kDynamic>& limits) const;

  /// The result of plain() as a type of the library, with given weights.
  template <Level kLevel, int N, typename Weights>
  [[nodiscard]] auto law(const Weights& W, const JointLimits<N>& limits) const {
    if constexpr (kLevel == Level::kVelocity) {
      return VelocityScheme<N, double, Weights>(W, k, null_space(limits), singular);
    } else {
      return AccelerationScheme<N, double, Weights>(alpha, W, k1, k2, null_space(limits), singular);
    }
  }

  /// law() with dynamics, of the robot of on().
  template <Level kLevel>
  [[nodiscard]] auto law_with_dynamics(const JointLimits<kDynamic>& limits) const {
    const SharedDynamics model{dynamics};
    if constexpr (kLevel == Level::kVelocity) {
      return WithDynamics<LeastEnergy>{LeastEnergy(model, k, null_space(limits), singular)};
    } else {
      const AnyWeights W = any_weights(*this, limits.lower.size());
      return WithDynamics<LeastTorque>{LeastTorque(model, alpha, W, k1, k2, null_space(limits), singular)};
    }
  }

  /// The weights as a diagonal of dof entries, which are 1 by default. Throws std::invalid_argument if the number of
  /// weights is not dof. W must not be dense.
  template <int N>
  [[nodiscard]] DiagonalWeights<N> diagonal_weights(Eigen::Index dof) const {
    const auto* w = std::get_if<Diagonal>(&weights);
    if (w == nullptr) return DiagonalWeights<N>(Vector<N>::Ones(dof));
    validation::require_size("weights", w->size(), dof);
    return DiagonalWeights<N>(Vector<N>(*w));
  }

  /// The secondary motion z of joints with the given limits.
  template <int N>
  [[nodiscard]] NullSpace<N> null_space(const JointLimits<N>& limits) const {
    const Eigen::Index dof = limits.lower.size();
    NullSpace<N> result;
    result = result.with_damping(null_damping);
    if (rest_posture) {
      validation::require_size("rest_posture", rest_posture->size(), dof);
      result = result.with_rest_posture(*rest_posture, null_stiffness);
    } else if (null_stiffness != 0.0) {
      validation::fail("null_stiffness", null_stiffness, "0 without rest_posture");
    }
    if (c) {
      validation::require_size("c", c->size(), dof);
      result = result.with_free_choice(*c);
    }
    if (joint_centring != 0.0) result = result.with_joint_centring(limits, joint_centring);
    return result.with_continuous_joints(limits.continuous);
  }

  template <typename Space>
  struct Kept {
    Eigen::Index dof = 0;
    JointBits continuous = 0;
    std::shared_ptr<const EitherScheme<Space>> scheme = {};
  };
  /// Results of kept().
  mutable std::tuple<Kept<Position<2>>, Kept<PlanarPose>, Kept<Position<3>>, Kept<Pose>> kept_ = {};
};

/// The parameters that are numbers; the default is 0.
inline constexpr std::pair<const char*, double Scheme::*> kSchemeNumbers[] = {
    {"alpha", &Scheme::alpha},
    {"k", &Scheme::k},
    {"k1", &Scheme::k1},
    {"k2", &Scheme::k2},
    {"null_damping", &Scheme::null_damping},
    {"null_stiffness", &Scheme::null_stiffness},
    {"joint_centring", &Scheme::joint_centring},
    {"manipulability_gain", &Scheme::manipulability_gain},
};

}  // namespace fpbm::bindings
