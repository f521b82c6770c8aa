#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm/any/any_scheme.hpp"
#include "fpbm/model/presets.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/objective/manipulability_ascent.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/scheme/schemes.hpp"

/// The options of a tracker apply to every scheme: damping, and rejection of gains that a tick cannot integrate.
namespace fpbm::test::tracker_options_laws {

/// A scheme without damping, and a scheme that keeps its settings.
struct Undampable {
  static constexpr Level kLevel = Level::kAcceleration;
  static constexpr int kDof = Eigen::Dynamic;

  void require_dof(Eigen::Index) const {}
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, kDof>&, const Reference<Space>&, const State<kDof>& state,
                               Vector<kDof>& qdd) const noexcept {
    qdd = Vector<kDof>::Zero(state.q.size());
    return Status::kOk;
  }
};
struct Recorder : Undampable {
  double* null_damping;
};
void set_damping(Recorder& scheme, const DefaultDamping<>& damping) {
  *scheme.null_damping = damping.null_space;
}

namespace {

constexpr int kOpen = Eigen::Dynamic;
using Joints = Vector<kOpen>;
using Arm = SerialArm<kOpen>;
template <Level kLevel>
using AnyLaw = AnyScheme<kLevel, Pose>;
using Accelerations = AnyLaw<Level::kAcceleration>;
using Velocities = AnyLaw<Level::kVelocity>;

struct Preset {
  const char* name;
  Chain<> chain;
  std::vector<double> ready;

  [[nodiscard]] Joints posture() const { return Eigen::Map<const Eigen::VectorXd>(ready.data(), arm().dof()); }
  [[nodiscard]] Arm arm() const { return Arm(chain); }
};

[[nodiscard]] std::vector<Preset> redundant() {
  return {{"panda", presets::panda(), {0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854}},
          {"fr3", presets::fr3(), {0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854}},
          {"iiwa14", presets::iiwa14(), {0.0, 0.5236, 0.0, -1.5708, 0.0, 1.0472, 0.0}},
          {"gen3", presets::gen3(), {0.0, 0.2618, 3.1416, -2.2689, 0.0, 0.9599, 1.5708}}};
}
[[nodiscard]] Preset ur5e() {
  return {"ur5e", presets::ur5e(), {0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0}};
}

[[nodiscard]] AccelerationScheme<kOpen> fpbm(int dof, const NullSpace<kOpen>& z = {},
                                             const SingularDamping<>& singular = SingularDamping<>::off()) {
  return FPBM<kOpen>(0.6, Joints(Joints::Ones(dof)), 10.0, 25.0, z, singular);
}
[[nodiscard]] VelocityScheme<kOpen> wmvn(int dof, const SingularDamping<>& singular = SingularDamping<>::off()) {
  return WMVN<kOpen>(Joints(Joints::Ones(dof)), 5.0, {}, singular);
}
[[nodiscard]] NullSpace<kOpen> damped(double damping) {
  return NullSpace<kOpen>().with_damping(damping);
}

template <typename Scheme>
[[nodiscard]] auto tracker_of(const Preset& preset, const Scheme& scheme, const TrackerOptions<>& options = {}) {
  return Tracker(preset.arm(), Pose{}, scheme, preset.posture(), options);
}

[[nodiscard]] TrackerOptions<> with_null_damping(double damping) {
  TrackerOptions<> options;
  options.null_damping = damping;
  return options;
}

struct Motion {
  std::vector<Joints> q;
  int damped = 0;
  double speed = 0.0;  ///< At the end.
  double moved = 0.0;  ///< In the last quarter.
};

/// Moves the tip toward a point for some seconds.
template <typename Tracker>
[[nodiscard]] Motion drawn(Tracker tracker, const Vector<3>& displacement, double seconds) {
  auto target = Reference<Pose>::hold(tracker.tip());
  target.x.p += displacement;
  Motion motion;
  const auto ticks = static_cast<std::size_t>(seconds * 1e3);
  for (std::size_t i = 0; i < ticks; ++i) {
    const auto tick = tracker.tick(target);
    motion.damped += tick.status == Status::kDamped ? 1 : 0;
    motion.q.push_back(tick.q);
    motion.speed = tick.qd.cwiseAbs().maxCoeff();
  }
  motion.moved = (motion.q.back() - motion.q[ticks * 3 / 4]).cwiseAbs().maxCoeff();
  return motion;
}

void expect_same(const Motion& one, const Motion& two, const std::string& what) {
  ASSERT_EQ(one.q.size(), two.q.size());
  for (std::size_t i = 0; i < one.q.size(); ++i) ASSERT_EQ(one.q[i], two.q[i]) << what << ", tick " << i;
}

/// With an unreachable target, the options damp an arm bitwise like a scheme with its own damping.
TEST(TrackerOptions, damp_schemes_of_run_time_type) {
  const Vector<3> far(1.5, 0.3, 0.2);
  const SingularDamping<> singular;
  std::vector<Preset> presets = redundant();
  presets.push_back(ur5e());
  for (const Preset& preset : presets) {
    const auto dof = static_cast<int>(preset.arm().dof());
    const auto z = dof > 6 ? damped(2.0) : NullSpace<kOpen>();
    const Motion own = drawn(tracker_of(preset, Accelerations(fpbm(dof, z, singular))), far, 4.0);
    const Motion given = drawn(tracker_of(preset, Accelerations(fpbm(dof))), far, 4.0);
    EXPECT_GT(given.damped, 100) << preset.name;
    expect_same(own, given, preset.name);
    const Motion own_velocity = drawn(tracker_of(preset, Velocities(wmvn(dof, singular))), far, 4.0);
    const Motion velocity = drawn(tracker_of(preset, Velocities(wmvn(dof))), far, 4.0);
    EXPECT_TRUE(velocity.damped > 100 || dof == 6) << preset.name;  // A UR5e is slowed by its limits.
    expect_same(own_velocity, velocity, preset.name);
  }
}

TEST(TrackerOptions, damp_schemes_in_wrappers) {
  const Vector<3> far(1.5, 0.3, 0.2);
  const Preset panda = redundant()[0];
  const auto wrapped = [&](const AccelerationScheme<kOpen>& scheme) {
    return Accelerations(ManipulabilityAscent(Accelerations(scheme), panda.arm(), 1.0));
  };
  const Motion own = drawn(tracker_of(panda, wrapped(fpbm(7, damped(2.0), SingularDamping<>()))), far, 4.0);
  const Motion given = drawn(tracker_of(panda, wrapped(fpbm(7))), far, 4.0);
  EXPECT_GT(given.damped, 100);
  expect_same(own, given, "wrapped");
}

/// For a scheme without null-space damping, and a motion within the limits.
TEST(TrackerOptions, bring_the_self_motion_to_rest) {
  const Vector<3> near(-0.05, 0.15, 0.1);
  for (const Preset& preset : redundant()) {
    const Motion usual = drawn(tracker_of(preset, Accelerations(fpbm(7))), near, 20.0);
    EXPECT_LE(usual.speed, 1e-6) << preset.name;
    EXPECT_LE(usual.moved, 1e-5) << preset.name;
    const Motion none = drawn(tracker_of(preset, Accelerations(fpbm(7)), with_null_damping(0.0)), near, 20.0);
    EXPECT_GE(none.speed, 1e-4) << preset.name << ": this motion shows nothing";
    // With a rest posture only, the motion oscillates without decay.
    const auto spring = NullSpace<kOpen>().with_rest_posture(preset.posture(), 4.0);
    EXPECT_LE(drawn(tracker_of(preset, Accelerations(fpbm(7, spring))), near, 20.0).speed, 1e-6) << preset.name;
  }
}

TEST(TrackerOptions, keep_the_damping_of_a_scheme) {
  const Vector<3> near(-0.05, 0.15, 0.1);
  const Preset panda = redundant()[0];
  const auto same = [&](const Preset& preset, const auto& scheme, const char* what) {
    expect_same(drawn(tracker_of(preset, scheme, with_null_damping(0.0)), near, 1.0),
                drawn(tracker_of(preset, scheme, with_null_damping(9.0)), near, 1.0), what);
  };
  same(panda, Accelerations(fpbm(7, damped(4.0))), "own damping");
  same(panda, Velocities(wmvn(7)), "velocity level");
  same(ur5e(), Accelerations(fpbm(6)), "no null space");
}

TEST(TrackerOptions, require_a_scheme_that_accepts_damping) {
  static_assert(kTakesDamping<Accelerations, double>);
  static_assert(kTakesDamping<VelocityScheme<7>, double>);
  static_assert(kTakesDamping<ManipulabilityAscent<AccelerationScheme<7>, SerialArm<7>>, double>);
  static_assert(!kTakesDamping<Undampable, double>);
  static_assert(!kTakesDamping<ManipulabilityAscent<Undampable, Arm>, double>);
  static_assert(kTakesDamping<Recorder, double>);
  static_assert(kTakesDamping<ManipulabilityAscent<Recorder, Arm>, double>);
  double given = -1.0;
  Recorder recording;
  recording.null_damping = &given;
  const Preset panda = redundant()[0];
  (void)tracker_of(panda, Accelerations(recording), with_null_damping(3.0));
  EXPECT_EQ(given, 3.0);
  (void)tracker_of(panda, Accelerations(ManipulabilityAscent(recording, panda.arm(), 1.0)));
  EXPECT_EQ(given, TrackerOptions<>().null_damping);
  (void)tracker_of(ur5e(), Accelerations(recording));
  EXPECT_EQ(given, 0.0);
}

/// The message with which a tracker rejects a scheme, or an empty string.
template <typename Law>
[[nodiscard]] std::string refusal(const Law& law, double dt, double integral_gain = 0.0, double null_damping = 2.0) {
  TrackerOptions<> options;
  options.dt = dt;
  options.integral_gain = integral_gain;
  options.null_damping = null_damping;
  try {
    (void)tracker_of(redundant()[0], AnyLaw<Law::kLevel>(law), options);
    return "";
  } catch (const ParameterError& error) {
    EXPECT_STREQ(error.name().c_str(), std::string(error.what()).substr(0, error.name().size()).c_str());
    return error.what();
  }
}

/// The number after a text.
[[nodiscard]] double number_after(const std::string& message, const std::string& text) {
  const std::size_t at = message.find(text);
  EXPECT_NE(at, std::string::npos) << message;
  return at == std::string::npos ? 0.0 : std::strtod(message.c_str() + at + text.size(), nullptr);
}

/// Checks that the message make(value) for a large value contains the largest accepted value, to 0.1 %.
template <typename Make>
void expect_a_limit(const std::string& name, double limit, const Make& make) {
  const std::string message = make(3.0 * limit);
  EXPECT_EQ(message.find(name + " = "), 0U) << message;
  EXPECT_NE(message.find("shorten the tick"), std::string::npos) << message;
  const double most = number_after(message, "must be at most ");
  EXPECT_LE(most, limit * (1.0 + 1e-6)) << message;
  EXPECT_GE(most, limit * (1.0 - 1e-3)) << message;
  EXPECT_EQ(make(most), "");
  EXPECT_NE(make(1.002 * most), "");
}

TEST(TickGains, beyond_the_stability_bound_of_a_tick_are_rejected) {
  const Joints ones = Joints::Ones(7);
  constexpr double kRealAxis = 2.785293563;  // RK4's 1 + z + z²/2 + z³/6 + z⁴/24 is 1 again.
  for (const double dt : {1e-3, 4e-3, 0.02}) {
    expect_a_limit("null_damping", 1.0 / dt, [&](double value) { return refusal(fpbm(7, damped(value)), dt); });
    expect_a_limit("null_damping", 1.0 / dt, [&](double value) { return refusal(fpbm(7), dt, 0.0, value); });
    expect_a_limit("null_stiffness", 0.1 / dt / dt,
                   [&](double value) { return refusal(fpbm(7, damped(0.9 / dt).with_rest_posture(ones, value)), dt); });
    expect_a_limit("k", kRealAxis / dt, [&](double value) { return refusal(WMVN<kOpen>(ones, value), dt); });
    expect_a_limit("null_stiffness", 1.0 / dt, [&](double value) {
      return refusal(WMVN<kOpen>(ones, 5.0, NullSpace<kOpen>().with_rest_posture(ones, value)), dt);
    });
    expect_a_limit("k1", kRealAxis / dt, [&](double value) { return refusal(FPBM<kOpen>(0.6, ones, value, 0.0), dt); });
    expect_a_limit("k2", 6.0 / dt / dt, [&](double value) { return refusal(FPBM<kOpen>(0.6, ones, 0.0, value), dt); });

    const std::string both =
        refusal(FPBM<kOpen>(0.6, ones, 5.0 / dt, 6.25 / dt / dt), dt);  // a critically damped error
    const double k1 = number_after(both, "k1 = " + std::to_string(std::lround(5.0 / dt)) + ": must be at most ");
    const double k2 = number_after(both, " with k2 = ");
    EXPECT_NEAR(k1 * k1 / k2, 4.0, 1e-6) << both;
    EXPECT_EQ(refusal(FPBM<kOpen>(0.6, ones, k1, k2), dt), "");
    EXPECT_NE(refusal(FPBM<kOpen>(0.6, ones, 1.001 * k1, 1.001 * 1.001 * k2), dt), "");
  }
  EXPECT_NE(refusal(FPBM<kOpen>(0.6, ones, 1e300, 1e300), 1e-3), "");
}

TEST(TickGains, an_integral_beyond_the_Routh_bound_is_rejected) {
  for (const double dt : {1e-3, 4e-3, 0.02}) {
    const std::string message = refusal(fpbm(7), dt, 1000.0);
    const double most = number_after(message, "integral_gain = 1000: must be at most ");
    EXPECT_LE(most, 250.0);  // k₁k₂, minus the effect of the tick.
    EXPECT_GE(most, 250.0 * (1.0 - 13.0 * dt));
    EXPECT_EQ(refusal(fpbm(7), dt, most), "");
    const double most_velocity = number_after(refusal(wmvn(7), dt, 100.0 / dt), "must be at most ");
    EXPECT_NEAR(most_velocity * dt, 5.0, 0.3);  // k/h.
    EXPECT_EQ(refusal(wmvn(7), dt, most_velocity), "");
  }
  EXPECT_NE(refusal(MAN<kOpen>(), 1e-3, 1.0).find("integral_gain = 1: must be at most 0"), std::string::npos);
}

/// is_stable_…() returns whether errors decay from tick to tick, for any gains and in float too.
TEST(TickGains, are_stable_if_and_only_if_errors_decay) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> size(-2.0, 0.7);
  int stable = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double x1 = std::pow(10.0, size(random));
    const double x2 = std::pow(10.0, 2.0 * size(random) - 0.5);
    const double x3 = trial % 2 == 0 ? 0.0 : std::pow(10.0, 3.0 * size(random) - 1.5);
    // The tick as a matrix for e, ė and the integral; its 2³⁰th power.
    const auto growth = [&](bool mean) {
      Matrix<3, 3> power;
      for (int column = 0; column < 3; ++column) {
        const Vector<3> state = Vector<3>::Unit(column);
        const auto f = [&](double, const Vector<2>& at, Vector<2>& dx) noexcept {
          dx = Vector<2>(at(1), -x1 * at(1) - x2 * at(0) - x3 * state(2));
          return Status::kOk;
        };
        Vector<2> x = state.head<2>();
        (void)RK4::step(f, 0.0, 1.0, x);
        if (mean) x(0) = state(0) + (state(1) + x(1)) / 2.0;
        power.col(column) << x, state(2) + state(0);
      }
      const int rows = x3 == 0.0 ? 2 : 3;
      Matrix<kOpen, kOpen> some = power.topLeftCorner(rows, rows);
      for (int i = 0; i < 30 && some.norm() < 1e9; ++i) some = (some * some).eval();
      return some.norm();
    };
    const double end = std::max(growth(false), growth(true));
    if (end > 1e-2 && end < 1e3) continue;  // On the boundary.
    EXPECT_EQ(is_stable_acceleration(x1, x2, x3), end <= 1e-2) << x1 << " " << x2 << " " << x3;
    stable += end <= 1e-2 ? 1 : 0;
  }
  EXPECT_GT(stable, 300);
  EXPECT_LT(stable, 1500);
  for (const float x : {1e-6F, 1e-3F, 0.1F, 1.0F}) {
    EXPECT_TRUE(is_stable_acceleration(0.0F, x * x));
    EXPECT_TRUE(is_stable_acceleration(2.0F * x, x * x));
    EXPECT_TRUE(is_stable_acceleration(2.0F * x, x * x, 0.2F * x * x * x));
    EXPECT_FALSE(is_stable_acceleration(2.0F * x, x * x, 2.2F * x * x * x));
    EXPECT_TRUE(is_stable_velocity(x));
  }
  EXPECT_TRUE(is_stable_acceleration(0.0, 0.0));
  EXPECT_TRUE(is_stable_velocity(0.0));
}

/// For several levels: is_stable_acceleration_of_levels() for ticks by TickFeedback, and is_stable_…_of_middle() for
/// ticks that continue the motion of the last tick to their middle.
TEST(TickGains, of_several_levels_are_stable_if_and_only_if_errors_decay) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> size(-2.0, 0.3);
  std::array<int, 3> stable{};
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double x1 = std::pow(10.0, size(random));
    const double x2 = std::pow(10.0, 2.0 * size(random) - 0.5);
    const double x3 = trial % 2 == 0 ? 0.0 : std::pow(10.0, 3.0 * size(random) - 1.0);
    const int integral = x3 == 0.0 ? 0 : 1;
    const auto decays = [&](Matrix<kOpen, kOpen> power) {
      for (int i = 0; i < 30 && power.norm() < 1e9; ++i) power = (power * power).eval();
      return power.norm();
    };
    const auto expect = [&](std::size_t law, bool claimed, const Matrix<kOpen, kOpen>& tick) {
      const double end = decays(tick);
      if (end > 1e-2 && end < 1e3) return;  // On the boundary.
      EXPECT_EQ(claimed, end <= 1e-2) << "law " << law << ": " << x1 << " " << x2 << " " << x3;
      stable[law] += end <= 1e-2 ? 1 : 0;
    };
    // For e, ė and the acceleration of the last tick (or e and the velocity), and the integral.
    Matrix<4, 4> task = Matrix<4, 4>::Zero();
    Matrix<3, 3> null_space = Matrix<3, 3>::Zero();
    Matrix<3, 3> velocity = Matrix<3, 3>::Zero();
    const TickFeedback<> feedback(x1, x2, 1.0);
    for (int column = 0; column < 4; ++column) {
      const Vector<4> at = Vector<4>::Unit(column);
      const double middle = at(0) + at(1) / 2.0 + at(2) / 8.0;
      const double by_task = feedback.previous_weight * at(2) - (1.0 - feedback.previous_weight) * x3 * at(3) -
                             feedback.velocity_gain * 2.0 * (middle - at(0)) - feedback.position_gain * middle;
      task.col(column) << at(0) + at(1) + by_task / 2.0, at(1) + by_task, by_task, at(3) + at(0);
      if (column == 3) continue;
      const double a = -x1 * (at(1) + at(2) / 2.0) - x2 * middle;
      null_space.col(column) << at(0) + at(1) + a / 2.0, at(1) + a, a;
      const double v = -x1 * (at(0) + at(1) / 2.0) - x3 * at(2);
      velocity.col(column) << at(0) + v, v, at(2) + at(0);
    }
    expect(0, is_stable_velocity_of_middle(x1, x3), velocity.topLeftCorner(2 + integral, 2 + integral));
    expect(1, is_stable_acceleration_of_middle(x1, x2), null_space);
    // Gains that RK4 does not damp are rejected earlier.
    if (is_stable_acceleration(x1, x2)) {
      expect(2, is_stable_acceleration_of_levels(x1, x2, x3), task.topLeftCorner(3 + integral, 3 + integral));
    }
  }
  for (const int count : stable) {
    EXPECT_GT(count, kTrials / 8);
    EXPECT_LT(count, kTrials * 7 / 8);
  }
  for (const float x : {1e-6F, 1e-3F, 0.1F}) {
    EXPECT_TRUE(is_stable_acceleration_of_middle(2.0F * x, x * x));
    EXPECT_TRUE(is_stable_acceleration_of_levels(2.0F * x, x * x));
    EXPECT_TRUE(is_stable_acceleration_of_levels(2.0F * x, x * x, 0.2F * x * x * x));
    EXPECT_FALSE(is_stable_acceleration_of_levels(2.0F * x, x * x, 2.2F * x * x * x));
    EXPECT_TRUE(is_stable_velocity_of_middle(x));
  }
}

/// A tick by TickFeedback multiplies errors by e^(λh), up to terms of (λh)⁵, where λ² + k₁λ + k₂ = 0.
TEST(TickGains, of_several_levels_have_the_roots_of_the_gains) {
  for (const double x1 : {0.01, 0.1, 0.3, 0.9}) {
    for (const double ratio : {0.1, 0.25, 1.0}) {
      const double x2 = ratio * x1 * x1;
      const TickFeedback<> feedback(x1, x2, 1.0);
      Matrix<2, 2> tick;
      for (int column = 0; column < 2; ++column) {
        const Vector<2> at = Vector<2>::Unit(column);
        const double middle = at(0) + at(1) / 2.0;  // After a tick at rest: ẍ' = 0.
        const double a = -feedback.velocity_gain * 2.0 * (middle - at(0)) - feedback.position_gain * middle;
        tick.col(column) << at(0) + at(1) + a / 2.0, at(1) + a;
      }
      const std::complex<double> root = std::sqrt(std::complex<double>(x1 * x1 / 4.0 - x2));
      const std::complex<double> a = std::exp(-x1 / 2.0 + root);
      const std::complex<double> b = std::exp(-x1 / 2.0 - root);
      EXPECT_NEAR(tick.trace(), (a + b).real(), 0.1 * std::pow(x1, 5)) << x1 << " " << ratio;
      EXPECT_NEAR(tick(0, 0) * tick(1, 1) - tick(0, 1) * tick(1, 0), (a * b).real(), 0.1 * std::pow(x1, 5))
          << x1 << " " << ratio;
    }
  }
}

/// With critical damping, the tip does not move, and the arm stops.
TEST(TickGains, a_stiff_rest_posture_does_not_change_the_task) {
  const Preset panda = redundant()[0];
  for (const double dt : {1e-3, 0.02}) {
    TrackerOptions<> options;
    options.dt = dt;
    const double stiffness = 0.03 / dt / dt;
    Joints rest = panda.posture();
    rest(0) += 0.3;
    const auto z = damped(2.0 * std::sqrt(stiffness)).with_rest_posture(rest, stiffness);
    Tracker tracker(panda.arm(), Pose{}, Accelerations(fpbm(7, z)), panda.posture(), options);
    const auto hold = Reference<Pose>::hold(tracker.tip());
    Tick<Pose, kOpen> tick = tracker.tick(hold);
    for (double t = 0.0; t < 20.0; t += dt) tick = tracker.tick(hold);
    EXPECT_LE(tick.error.norm(), 1e-9) << dt;
    EXPECT_LE(tick.qd.cwiseAbs().maxCoeff(), 1e-6) << dt;
  }
}

}  // namespace
}  // namespace fpbm::test::tracker_options_laws
