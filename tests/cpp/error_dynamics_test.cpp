#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/random.hpp"
#include "support/recording.hpp"

/// The tip error of FPBM satisfies ë + k₁ė + k₂e = 0 for all α, W and z.
namespace fpbm::test::error_dynamics_laws {
namespace {

/// Solution of ë + k₁ė + k₂e = 0 from e(0), ė(0), by the characteristic roots.
template <int M>
Vector<M> closed_form(double k1, double k2, double t, const Vector<M>& e0, const Vector<M>& ed0) {
  const std::complex<double> root = std::sqrt(std::complex<double>(k1 * k1 / 4.0 - k2));
  const double decay = std::exp(-k1 / 2.0 * t);
  const Vector<M> slope = ed0 + k1 / 2.0 * e0;
  if (root == 0.0) return decay * (e0 + t * slope);
  return decay * (std::cosh(root * t).real() * e0 + (std::sinh(root * t) / root).real() * slope);
}

struct Gains {
  double k1;
  double k2;
};
constexpr Gains kUndamped{0.0, 4.0};
constexpr Gains kUnderdamped{1.0, 1.0};
constexpr Gains kCritical{4.0, 4.0};
constexpr Gains kOverdamped{6.0, 2.0};
constexpr Gains kVelocityOnly{2.0, 0.0};
constexpr Gains kNone{0.0, 0.0};

NullSpace<4> damped() {
  return NullSpace<4>{}.with_damping(2.0);
}

/// From a wrong start velocity, in a rollout: e(0) = 0, ė(0) = xd(0) − J qd(0).
TEST(ErrorDynamics, of_a_start_velocity_error_are_those_of_the_gains) {
  const State<4> start{paper_start().q, Vector<4>(0.01, -0.04, 0.02, 0.03)};
  for (const auto& [k1, k2] : {kUndamped, kUnderdamped, kCritical, kOverdamped, kVelocityOnly, kNone}) {
    for (const double alpha : {0.0, 0.3, 0.6, 1.0}) {
      SCOPED_TRACE("k1 = " + std::to_string(k1) + ", k2 = " + std::to_string(k2) +
                   ", alpha = " + std::to_string(alpha));
      const auto scheme = FPBM<4>(alpha, paper_weights(), k1, k2, damped());
      const auto run = recorded(paper_arm(), paper_circle(), scheme, start, TimeGrid<>(kDuration, 1e-3));
      ASSERT_EQ(run.result.status, Status::kOk) << "at " << run.result.time << " s";
      Kinematics<Position<2>, 4> kinematics;
      paper_arm().kinematics(start.q, kinematics);
      const Vector<2> ed0 = -kinematics.J * start.qd;
      for (const auto& sample : run.samples) {
        const Vector<2> expected = closed_form<2>(k1, k2, sample.t, Vector<2>::Zero(), ed0);
        ASSERT_LE((sample.error - expected).norm(), 1e-9) << "t = " << sample.t;
      }
    }
  }
}

/// From a wrong start position too: RK4 with an offset reference and random dense weights.
TEST(ErrorDynamics, of_a_start_position_error_are_those_of_the_gains) {
  using Scheme = AccelerationScheme<4, double, DenseWeights<4>>;
  const PlanarArm<4> arm = paper_arm();
  const auto path = paper_circle();
  const Vector<4> bent(0.3, 0.6, 0.6, 0.6);  // The posture of the paper is too straight for e0.
  for (const auto& [k1, k2] : {kUnderdamped, kCritical, kOverdamped}) {
    for (std::uint32_t seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE("k1 = " + std::to_string(k1) + ", k2 = " + std::to_string(k2) + ", seed " + std::to_string(seed));
      Random random(seed);
      const DenseWeights<4> weights(Matrix<4, 4>(random.positive_definite(4)));
      const Scheme scheme = FPBM<4>(random.uniform(0.0, 1.0), weights, k1, k2, damped());
      const Vector<2> e0 = random.uniform(2, -0.2, 0.2);

      using Loop = ClosedLoop<PlanarArm<4>, Scheme, Position<2>>;
      Loop loop{arm, scheme, {}, {bent, Vector<4>::Zero()}, Vector<4>::Zero()};
      arm.kinematics(bent, loop.kinematics);
      const Vector<2> origin = loop.kinematics.tip + e0;
      const auto reference = [&](double t) noexcept {
        Reference<Position<2>> at = path.sample(t);
        at.x += origin;
        return at;
      };
      const auto derivative = [&](double t, const Loop::X& x, Loop::X& dx) noexcept {
        return loop.evaluate(reference(t), x, dx);
      };
      Loop::X x;
      x << bent, random.uniform(4, -0.1, 0.1);
      const Vector<2> ed0 = -loop.kinematics.J * x.col(1);

      constexpr double kStep = 1e-3;
      for (int i = 0; i < 8000; ++i) {
        ASSERT_EQ(RK4::step(derivative, i * kStep, kStep, x), Status::kOk);
        const double t = (i + 1) * kStep;
        arm.kinematics(x.col(0), loop.kinematics);
        const Vector<2> error = reference(t).x - loop.kinematics.tip;
        ASSERT_LE((error - closed_form<2>(k1, k2, t, e0, ed0)).norm(), 1e-9) << "t = " << t;
      }
    }
  }
}

/// Two levels, in ticks (TickFeedback), up to terms of (k₁h)². The target jumps, while the lower
/// level moves the joints.
TEST(ErrorDynamics, of_several_levels_are_those_of_the_gains) {
  const Robot<7> robot(presets::panda());
  const auto scheme = Balanced<7>(0.0, UnitWeights{}, NullSpace<7>().with_damping(2.0));
  const Vector<7> q0{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785};
  const Vector<3> e0(1e-6, -5e-7, 3e-7);
  for (const double k1 : {10.0, 30.0, 100.0, 300.0, 900.0}) {
    for (const double ratio : {0.25, 1.0}) {
      const double k2 = ratio * k1 * k1;
      const Stack stack(PositionTask<>{{Robot<7>::kTip}, {k1, k2}}, PostureTask<7>{TaskGains<>(4.0, 4.0)});
      auto tracker = stack_tracker(robot, stack, scheme, q0);
      auto target = decltype(tracker)::Target::hold(tracker.tip());
      std::get<0>(target.x) += e0;
      std::get<1>(target.x)(2) += 0.05;
      const double bound = 0.06 * k1 * k1 * 1e-6 * e0.norm();
      for (int i = 1; i <= 2000; ++i) {
        ASSERT_EQ(tracker.tick(target).status, Status::kOk);
        const Vector<3> error = std::get<0>(target.x) - std::get<0>(tracker.tip());
        const Vector<3> expected = closed_form<3>(k1, k2, i * 1e-3, e0, Vector<3>::Zero());
        ASSERT_LE((error - expected).norm(), bound) << "k1 = " << k1 << ", k2 = " << k2 << ", tick " << i;
      }
    }
  }
}

/// The chain in float.
Chain<float> rounded(const Chain<>& chain) {
  const auto to_float = [](const Transform<>& at) {
    Transform<float> result;
    result.p = at.p.cast<float>();
    result.R = at.R.cast<float>();
    return result;
  };
  Chain<float> result{{}, to_float(chain.tip)};
  for (const Joint<>& joint : chain.joints) {
    Joint<float> same{joint.type, to_float(joint.placement), joint.axis.cast<float>()};
    same.bounds.lower = static_cast<float>(joint.bounds.lower);
    same.bounds.upper = static_cast<float>(joint.bounds.upper);
    same.bounds.velocity = static_cast<float>(joint.bounds.velocity);
    same.bounds.acceleration = static_cast<float>(joint.bounds.acceleration);
    same.bounds.jerk = static_cast<float>(joint.bounds.jerk);
    result.joints.push_back(same);
  }
  return result;
}

/// In float, the feedback does not amplify the round-off error of positions: the joint accelerations become zero.
TEST(ErrorDynamics, of_several_levels_settle_in_float) {
  const Robot<7, float> robot(rounded(presets::panda()));
  const Stack stack(AxisTask<float>{{Robot<7, float>::kTip}, {200.0F, 10000.0F}},
                    PositionTask<3, float>{{Robot<7, float>::kTip}, {200.0F, 10000.0F}},
                    PostureTask<7, float>{TaskGains<float>(4.0F, 4.0F)});
  const auto scheme = Balanced<7, float>(0.6F, UnitWeights{}, NullSpace<7, float>().with_damping(2.0F));
  TrackerOptions<float> options;
  options.dt = 4e-3F;
  const Vector<7, float> q0{0.0F, -0.3F, 0.0F, -2.2F, 0.0F, 2.0F, 0.785F};
  auto tracker = stack_tracker(robot, stack, scheme, q0, options);
  auto target = decltype(tracker)::Target::hold(tracker.tip());
  std::get<1>(target.x) += Vector<3, float>(0.1F, 0.2F, -0.1F);
  for (int i = 0; i < 8000; ++i) {
    const auto tick = tracker.tick(target);
    if (i < 7000) continue;
    ASSERT_LT(tick.error.head<6>().norm(), 1e-5F) << i;
    ASSERT_LT(tick.qdd.norm(), 1e-3F) << i;
  }
}

/// Two levels on a circle: the error is of the order of h², with the factor of the corrections of TickFeedback and
/// TickReferences::middle().
TEST(ErrorDynamics, of_several_levels_follow_paths) {
  const Robot<7> robot(presets::panda());
  const auto scheme = Balanced<7>(0.6, UnitWeights{}, NullSpace<7>().with_damping(5.0));
  const TaskGains<> gains(40.0, 400.0);
  const Stack stack(PositionTask<>{{Robot<7>::kTip}, gains}, AxisTask<>{{Robot<7>::kTip}, gains});
  for (const double dt : {1e-2, 5e-3, 1e-3}) {
    TrackerOptions<> options;
    options.dt = dt;
    auto tracker = stack_tracker(robot, stack, scheme, Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785}, options);
    using Target = decltype(tracker)::Target;
    const auto start = tracker.tip();
    const auto at = [&](double t) noexcept {
      constexpr double kRate = 1.5;
      const double sine = 0.05 * std::sin(kRate * t);
      const double cosine = 0.05 * std::cos(kRate * t);
      Target target = Target::hold(start);
      std::get<0>(target.x).head<2>() += Vector<2>(sine, 0.05 - cosine);
      target.xd.head<2>() = kRate * Vector<2>(cosine, sine);
      target.xdd.head<2>() = kRate * kRate * Vector<2>(-sine, cosine);
      return target;
    };
    double worst = 0.0;
    for (int i = 0; i * dt < 4.0; ++i) {
      const double t = i * dt;
      const auto references = decltype(tracker)::References::of([&](double s) noexcept { return at(t + s); }, dt);
      const Status status = tracker.advance(references).status;
      if (t < 2.0) continue;  // The start is at rest, without the velocity of the circle.
      ASSERT_EQ(status, Status::kOk);
      worst = std::max(worst, (std::get<0>(at(t + dt).x) - std::get<0>(tracker.tip())).norm());
    }
    EXPECT_LE(worst, 2.5e-5 * dt * dt) << dt;
  }
}

/// At velocity level, ė + k e = 0: an error decays at the rate of the gain.
TEST(ErrorDynamics, at_velocity_level_are_a_decay) {
  const PlanarArm<4> arm = paper_arm();
  const auto scheme = WMVN<4>(paper_weights(), 3.0);
  using Loop = ClosedLoop<PlanarArm<4>, VelocityScheme<4>, Position<2>>;
  Loop loop{arm, scheme, {}, paper_start(), Vector<4>::Zero()};
  arm.kinematics(paper_start().q, loop.kinematics);
  const Vector<2> e0(0.1, -0.2);
  const auto target = Reference<Position<2>>::hold(loop.kinematics.tip + e0);
  const auto derivative = [&](double, const Loop::X& x, Loop::X& dx) noexcept { return loop.evaluate(target, x, dx); };
  Loop::X x = paper_start().q;
  constexpr double kStep = 1e-3;
  for (int i = 0; i < 3000; ++i) {
    ASSERT_EQ(RK4::step(derivative, i * kStep, kStep, x), Status::kOk);
    arm.kinematics(x, loop.kinematics);
    const Vector<2> expected = std::exp(-3.0 * (i + 1) * kStep) * e0;
    ASSERT_LE((target.x - loop.kinematics.tip - expected).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace fpbm::test::error_dynamics_laws
