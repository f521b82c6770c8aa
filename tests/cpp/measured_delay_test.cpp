#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "fpbm/model/presets.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"
#include "support/random.hpp"

/// resolve_measured() for states that are several ticks old, quantised and noisy: after stop(), the arm stops,
/// and no bound is exceeded.
namespace fpbm::test::measured_delay_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr double kTick = 1e-3;
constexpr double kSlack = 1e-6;  // [rad]

using Joints = Vector<kOpen>;

/// An arm whose state is measured with a delay.
template <int N>
class LateArm {
 public:
  /// oldest: largest age of the measured states [ticks].
  LateArm(const State<N>& start, int oldest) : state_(start), oldest_(oldest) {}

  [[nodiscard]] const State<N>& state() const noexcept { return state_; }

  /// The state `age` ticks ago.
  [[nodiscard]] const State<N>& late(int age) const noexcept {
    return age == 0 || past_.empty() ? state_
                                     : past_[past_.size() - std::min(past_.size(), static_cast<std::size_t>(age))];
  }

  void advance(const Vector<N>& qdd, double tick = kTick) {
    past_.push_back(state_);
    if (static_cast<int>(past_.size()) > oldest_) past_.erase(past_.begin());
    state_.q += tick * (state_.qd + tick / 2.0 * qdd);
    state_.qd += tick * qdd;
  }

 private:
  State<N> state_;
  int oldest_;
  std::vector<State<N>> past_;
};

/// Errors of the measured states.
struct Sensor {
  double step;   // Resolution, to whose multiples positions are rounded [rad].
  double noise;  // Largest error of velocities, in both directions [rad/s].

  template <int N>
  [[nodiscard]] State<N> operator()(const State<N>& state, Random& random) const {
    State<N> seen = state;
    if (step > 0.0) seen.q = step * (state.q / step).array().round().matrix();
    if (noise > 0.0) seen.qd += random.uniform(static_cast<int>(seen.qd.size()), -noise, noise);
    return seen;
  }
};

constexpr std::array<Sensor, 3> kSensors{Sensor{0.0, 0.0}, Sensor{1e-5, 1e-3}, Sensor{1e-4, 1e-3}};

/// Bounds of a preset: without bounds on jerk, with the manufacturer's bounds on jerk if they exist, or with long
/// ramps.
[[nodiscard]] JointLimits<kOpen> bounds_of(const AnyArm<Position<3>>& arm, int kind) {
  JointLimits<kOpen> bounds = arm.limits();
  if (kind == 0) bounds.jerk.setConstant(std::numeric_limits<double>::infinity());
  if (kind == 1 && !std::isfinite(bounds.jerk(0))) bounds.jerk = 500.0 * bounds.acceleration;
  if (kind == 2) bounds.jerk = 25.0 * bounds.acceleration;
  return bounds;
}

[[nodiscard]] Joints middle(const JointLimits<kOpen>& bounds, Random& random) {
  const Joints lower = bounds.lower.cwiseMax(-3.0);
  const Joints upper = bounds.upper.cwiseMin(3.0);
  const Joints share = random.uniform(static_cast<int>(lower.size()), 0.2, 0.8);
  return lower + share.cwiseProduct(upper - lower);
}

/// Checks the bounds on positions and velocities.
void expect_within(const JointLimits<kOpen>& bounds, const State<kOpen>& state, const Sensor& sensor) {
  ASSERT_LE((state.q - bounds.upper).maxCoeff(), kSlack);
  ASSERT_LE((bounds.lower - state.q).maxCoeff(), kSlack);
  ASSERT_LE((state.qd.cwiseAbs() - bounds.velocity).maxCoeff(), 1e-9 + sensor.noise);
}

/// Moves fast toward targets that jump, until stop(). Within one second after stop(), every acceleration is below 1 %
/// of its bound.
///
/// busiest: raised to the largest fraction of an acceleration bound.
template <typename Space>
void expect_to_stop(const presets::Preset& preset, int kind, int delay, int age, const Sensor& sensor,
                    double& busiest) {
  const AnyArm<Position<3>> arm = any_arm(preset.chain());
  const JointLimits<kOpen> bounds = bounds_of(arm, kind);
  Random random(static_cast<std::uint32_t>(100 * kind + 10 * delay + age));
  const State<kOpen> start{middle(bounds, random), Joints::Zero(arm.dof())};
  const auto scheme =
      FPBM<kOpen>(0.6, Joints(Joints::Ones(arm.dof())), 20.0, 100.0, NullSpace<kOpen>{}.with_damping(2.0));
  TrackerOptions<> options;
  options.measured_delay = delay;
  CompiledTracker tracker(arm, Space{}, scheme, start, options, Limits<Level::kAcceleration, kOpen>(bounds, kTick));
  LateArm<kOpen> late(start, delay);
  Reference<Space> target = Reference<Space>::hold(tracker.tip());
  double fastest = 0.0;
  double rate = 0.0;
  const auto tick = [&] {
    const auto seen = sensor(late.late(age), random);
    const auto answer = tracker.resolve_measured(seen.q, seen.qd, target);
    late.advance(answer.qdd);
    expect_within(bounds, late.state(), sensor);
    fastest = std::max(fastest, late.state().qd.cwiseQuotient(bounds.velocity).cwiseAbs().maxCoeff());
    rate = std::max(rate, late.state().qd.cwiseAbs().maxCoeff());
    return answer.qdd.cwiseQuotient(bounds.acceleration).cwiseAbs().maxCoeff();
  };
  for (int i = 0; i < 1200; ++i) {
    if (i % 300 == 0) {
      Vector<Space::kRows> jump = random.uniform(Space::kRows, -1.0, 1.0);
      target = Reference<Space>::hold(Space::template displace<double>(tracker.tip(), jump));
    }
    tick();
    if (::testing::Test::HasFatalFailure()) FAIL() << "tick " << i;
  }
  EXPECT_TRUE(fastest > 0.2 || rate > 0.5) << fastest << ", " << rate;  // SO-101: bounds of 4.71 rad/s.
  tracker.stop();
  double busy = 0.0;
  for (int i = 0; i < 1300; ++i) {
    const double share = tick();
    if (::testing::Test::HasFatalFailure()) FAIL() << "tick " << i << " after stop()";
    if (i >= 1000) busy = std::max(busy, share);
  }
  EXPECT_LE(busy, 0.01);
  busiest = std::max(busiest, busy);
}

template <typename Space>
void expect_every_preset_to_stop(std::array<double, kSensors.size()>& busiest) {
  for (const presets::Preset& preset : presets::kAll) {
    if (preset.chain().joints.size() < Space::kRows) continue;
    for (int kind = 0; kind < 3; ++kind) {
      for (const int delay : {1, 3}) {
        for (int age = 0; age <= delay; ++age) {
          const auto which = static_cast<std::size_t>(age + delay + kind) % kSensors.size();
          const Sensor& sensor = kSensors[which];
          SCOPED_TRACE(::testing::Message() << preset.name << ", bounds " << kind << ", declared " << delay << ", age "
                                            << age << ", step " << sensor.step);
          expect_to_stop<Space>(preset, kind, delay, age, sensor, busiest[which]);
        }
      }
    }
  }
}
TEST(MeasuredDelay, every_preset_stops) {
  std::array<double, kSensors.size()> busiest{};
  expect_every_preset_to_stop<Pose>(busiest);
  expect_every_preset_to_stop<Position<3>>(busiest);
  for (std::size_t i = 0; i < kSensors.size(); ++i) {
    std::printf("step %g rad, noise %g rad/s: 1 s after stop() at most %.2f %% of a bound\n", kSensors[i].step,
                kSensors[i].noise, 100.0 * busiest[i]);
  }
}

/// The null-space motion pushes a joint against its bound, and the joint stops there. Returns whether the joint
/// was at its bound.
[[nodiscard]] bool rests_on_bound(const presets::Preset& preset, int kind, int age, const Sensor& sensor) {
  const AnyArm<Position<3>> arm = any_arm(preset.chain());
  JointLimits<kOpen> bounds = bounds_of(arm, kind);
  Random random(static_cast<std::uint32_t>(10 * kind + age));
  const State<kOpen> start{middle(bounds, random), Joints::Zero(arm.dof())};
  const Eigen::Index joint = 1 + (age + kind) % 3;
  Joints beyond = start.q;
  beyond(joint) += 0.5;
  bounds.upper(joint) = start.q(joint) + 0.02;
  bounds.deceleration(joint) = std::numeric_limits<double>::infinity();
  bounds.velocity_offset(joint) = 0.0;
  const auto z = NullSpace<kOpen>{}.with_damping(8.0).with_rest_posture(beyond, 16.0);
  const auto scheme = FPBM<kOpen>(0.6, Joints(Joints::Ones(arm.dof())), 20.0, 100.0, z);
  const TrackerOptions<> options;
  CompiledTracker tracker(arm, Position<3>{}, scheme, start, options,
                          Limits<Level::kAcceleration, kOpen>(bounds, kTick));
  const auto target = Reference<Position<3>>::hold(tracker.tip());
  LateArm<kOpen> late(start, options.measured_delay);
  double busy = 0.0;
  double nearest = 1.0;
  for (int i = 0; i < 4000; ++i) {
    const auto seen = sensor(late.late(age), random);
    const Joints qdd = tracker.resolve_measured(seen.q, seen.qd, target).qdd;
    late.advance(qdd);
    expect_within(bounds, late.state(), sensor);
    if (::testing::Test::HasFatalFailure()) {
      ADD_FAILURE() << "tick " << i;
      return false;
    }
    nearest = std::min(nearest, bounds.upper(joint) - late.state().q(joint));
    if (i >= 3000) busy = std::max(busy, qdd.cwiseQuotient(bounds.acceleration).cwiseAbs().maxCoeff());
  }
  EXPECT_LE(busy, sensor.noise > 0.0 ? 0.1 : 0.01);
  return nearest < 4e-4;
}
TEST(MeasuredDelay, joints_rest_on_their_bounds) {
  int reached = 0;
  int count = 0;
  for (const presets::Preset& preset : presets::kAll) {
    for (int kind = 0; kind < 3; ++kind) {
      for (int age = 0; age <= 3; ++age) {
        for (const Sensor& sensor : {kSensors[0], kSensors[2]}) {
          SCOPED_TRACE(::testing::Message()
                       << preset.name << ", bounds " << kind << ", age " << age << ", step " << sensor.step);
          reached += rests_on_bound(preset, kind, age, sensor) ? 1 : 0;
          ++count;
        }
      }
    }
  }
  EXPECT_GE(reached, count * 9 / 10);
}

TEST(MeasuredDelay, is_validated) {
  const AnyArm<Position<3>> arm = any_arm(presets::ur5e());
  const auto scheme = FPBM<kOpen>(0.6, Joints(Joints::Ones(arm.dof())), 20.0, 100.0);
  const Joints q0 = Joints::Constant(6, 0.5);
  for (const int delay : {-1, kMaxMeasuredDelay + 1}) {
    TrackerOptions<> options;
    options.measured_delay = delay;
    try {
      const CompiledTracker tracker(arm, Position<3>{}, scheme, q0, options);
      FAIL() << delay;
    } catch (const ParameterError& error) {
      EXPECT_EQ(error.name(), "measured_delay");
      EXPECT_EQ(error.value(), delay);
    }
  }
}

}  // namespace
}  // namespace fpbm::test::measured_delay_laws
