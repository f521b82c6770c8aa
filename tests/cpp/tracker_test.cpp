#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"
#include "support/panda_answers.hpp"
#include "support/recording.hpp"

/// A tracker follows, slows down, pauses, stops on command and at the workspace boundary, and returns.
namespace fpbm::test::tracker_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr double kTick = 1e-3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

[[nodiscard]] Vector<7> bent() {
  Vector<7> q;
  q << 0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8;
  return q;
}

/// Usual settings: damped self-motion and a rest posture. The size is fixed for poses, and known at run time for
/// positions.
template <int N = 7>
[[nodiscard]] AccelerationScheme<N> settling(double k1 = 10.0, double k2 = 25.0) {
  Vector<7> weights;
  weights << 1, 2, 3, 4, 1, 1, 1;
  const auto z = NullSpace<N>{}.with_damping(4.0).with_rest_posture(bent(), 4.0);
  return FPBM<N>(0.6, Vector<N>(weights), k1, k2, z);
}
template <int N = 7>
[[nodiscard]] VelocityScheme<N> settling_velocity() {
  return WMVN<N>(Vector<N>(Vector<7>::Ones()), 5.0, NullSpace<N>{}.with_rest_posture(bent(), 1.0));
}

[[nodiscard]] SerialArm<7> panda() {
  return SerialArm<7>(panda_without_jerk());
}

template <typename Space = Pose, typename Scheme>
[[nodiscard]] auto panda_tracker(const Scheme& scheme, const TrackerOptions<>& options = {}) {
  const auto arm = [] {
    if constexpr (Scheme::kDof == kOpen) {
      return any_arm(panda_without_jerk());
    } else {
      return panda();
    }
  }();
  return CompiledTracker(arm, Space{}, scheme, Vector<Scheme::kDof>(bent()), options);
}

[[nodiscard]] AnyPath<Position<3>> circle(double duration = 4.0) {
  return AnyPath<Position<3>>(InPlane(Path(Circle(0.05), duration), Vector<3>::UnitY(), Vector<3>::UnitZ()));
}
[[nodiscard]] AnyPath<Pose> turning_circle(double duration = 4.0) {
  return AnyPath<Pose>(WithRotation(circle(duration), Vector<3>(0.1, 0.2, 0.3)));
}

template <typename Space>
[[nodiscard]] Reference<Space> moved(Reference<Space> reference, double forward) {
  if constexpr (std::is_same_v<Space, Pose>) {
    reference.x.p(0) += forward;
  } else {
    reference.x(0) += forward;
  }
  return reference;
}

/// A tick with a check of the bounds.
template <typename AnyTracker, typename Goal>
auto checked_tick(AnyTracker& tracker, Goal& goal) {
  const auto bounds = tracker.arm().limits();
  const auto before = tracker.state();
  const auto tick = tracker.tick(goal);
  EXPECT_LE((tick.q - bounds.upper).maxCoeff(), 1e-9);
  EXPECT_LE((bounds.lower - tick.q).maxCoeff(), 1e-9);
  EXPECT_LE((tick.qd.cwiseAbs() - bounds.velocity).maxCoeff(), 1e-9);
  EXPECT_LE((tick.qdd.cwiseAbs() - bounds.acceleration).maxCoeff(), 1e-9);
  EXPECT_LE(((tick.qd - before.qd).cwiseAbs() / kTick - bounds.acceleration).maxCoeff(), 1e-9);  // No jump in qd.
  return tick;
}

template <typename Result>
[[nodiscard]] bool same_bits(const Result& a, const Result& b) {
  return std::memcmp(a.q.data(), b.q.data(), sizeof a.q) == 0 &&
         std::memcmp(a.qd.data(), b.qd.data(), sizeof a.qd) == 0 &&
         std::memcmp(a.qdd.data(), b.qdd.data(), sizeof a.qdd) == 0 && a.status == b.status && a.scale == b.scale &&
         a.saturated == b.saturated;
}

/// The members of the library's class are only looked up, not called.
TEST(Tracker, is_noexcept) {
  using Own = Tracker<SerialArm<7>, Pose, AccelerationScheme<7>>;
  using Follower = PathFollower<AnyPath<Pose>>;
  const auto look = [](Own* tracker, Follower* follower, const Reference<Pose>& reference, const Vector<7>& q) {
    static_assert(noexcept(tracker->tick(reference))&& noexcept(tracker->tick(*follower)));
    static_assert(noexcept(tracker->resolve_measured(q, q, reference)));
    static_assert(noexcept(tracker->stop())&& noexcept(tracker->resume())&& noexcept(tracker->state()));
    static_assert(noexcept(tracker->tip()));
    static_assert(noexcept(follower->pause())&& noexcept(follower->resume())&& noexcept(follower->ahead(0.0)));
    static_assert(noexcept(follower->advance(0.0))&& noexcept(follower->done())&& noexcept(follower->time()));
  };
  look(nullptr, nullptr, Reference<Pose>::hold({}), bent());
}

/// Far from every limit, the tip follows the motion of a rollout. The null space of a tick is that of J + h'J̇, so that
/// the joints differ by terms of h.
TEST(Tracker, follows_the_motion_of_a_rollout) {
  const auto path = turning_circle();
  std::vector<Vector<7>> q;
  const State<7> start{bent(), Vector<7>::Zero()};
  for (const auto& sample : recorded(panda(), path, settling(), start, TimeGrid<>(4.0, kTick)).samples) {
    q.push_back(sample.q);
  }
  ASSERT_EQ(q.size(), 4001U);
  auto tracker = panda_tracker(settling());
  PathFollower follower(path, tracker.tip());
  for (int i = 0; i < 4000; ++i) {
    const auto tick = checked_tick(tracker, follower);
    ASSERT_EQ(tick.status, Status::kOk);
    ASSERT_EQ(tick.scale, 1.0);
    ASSERT_EQ(tick.saturated, 0U);
    ASSERT_LE((tick.q - q[static_cast<std::size_t>(i) + 1]).cwiseAbs().maxCoeff(), 1e-5) << i;
    ASSERT_LE(tick.error.norm(), 1e-8);
  }
  EXPECT_EQ(follower.time(), 4.0);  // Exact for any number of ticks.
}

TEST(Tracker, gives_the_same_bits_for_the_same_inputs) {
  auto one = panda_tracker(settling());
  auto two = panda_tracker(settling());
  Random random(3);
  auto reference = Reference<Pose>::hold(one.tip());
  for (int i = 0; i < 5000; ++i) {
    if (i % 50 == 0) {
      const Vector<6> displacement = random.uniform(6, -0.5, 0.5);
      reference = {Pose::displace<double>(one.tip(), displacement), random.uniform(6, -1.0, 1.0),
                   random.uniform(6, -1.0, 1.0)};
    }
    ASSERT_TRUE(same_bits(one.tick(reference), two.tick(reference))) << i;
  }
}

/// Targets that change while the arm moves.
template <typename Space, typename Scheme>
void expect_to_reach_changing_targets(const Scheme& scheme) {
  auto tracker = panda_tracker<Space>(scheme);
  const auto home = Reference<Space>::hold(tracker.tip());
  Random random(5);
  for (int change = 0; change < 8; ++change) {
    auto target = home;
    const Vector<Space::kRows> displacement = random.uniform(Space::kRows, -0.15, 0.15);
    target.x = Space::template displace<double>(home.x, displacement);
    for (int i = 0; i < 300; ++i) checked_tick(tracker, target);
  }
  for (int i = 0; i < 8000; ++i) checked_tick(tracker, home);
  EXPECT_LE(tracker.tick(home).error.norm(), 1e-9);
  EXPECT_LE(tracker.state().qd.norm(), 1e-3);
}
TEST(Tracker, reaches_targets_that_change) {
  expect_to_reach_changing_targets<Pose>(settling());
  expect_to_reach_changing_targets<Position<3>>(settling<kOpen>());
  expect_to_reach_changing_targets<Pose>(settling_velocity());
  expect_to_reach_changing_targets<Position<3>>(settling_velocity<kOpen>());
}

/// The tip stays on its path while the clock pauses and resumes, also if it resumes before the pause is complete.
TEST(Tracker, pauses_and_resumes_on_its_path) {
  auto tracker = panda_tracker(settling());
  PathFollower follower(turning_circle(), tracker.tip(), 0.5);
  const auto go = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      const auto tick = checked_tick(tracker, follower);
      ASSERT_EQ(tick.status, Status::kOk);
      // The path now ends within a tick, and its acceleration jumps there.
      ASSERT_LE(tick.error.norm(), follower.time() < 4.0 ? 5e-9 : 1e-5);
    }
  };
  go(1500);
  follower.pause();
  go(600);
  const double paused = follower.time();
  EXPECT_NEAR(paused, 1.5 + 0.25, 1e-9);
  EXPECT_EQ(follower.ahead(0.0).xd.norm(), 0.0);
  go(500);
  EXPECT_EQ(follower.time(), paused);
  follower.resume();
  go(200);
  follower.pause();
  go(100);
  follower.resume();
  go(8000);
  EXPECT_TRUE(follower.done());
  EXPECT_LE(Pose::difference<double>(follower.ahead(0.0).x, tracker.tip()).norm(), 5e-9);
}

/// In every phase, the reference velocity is the derivative of the position, and the reference acceleration is the
/// derivative of the velocity.
TEST(Tracker, follows_paths_smoothly) {
  PathFollower follower(circle(), Vector<3>(0.1, 0.2, 0.3), 0.5);
  const double h = 1e-5;
  for (int i = 0; i < 1000; ++i) {
    if (i == 200) follower.pause();
    if (i == 300 || i == 420) follower.resume();
    if (i == 400) follower.pause();
    const auto before = follower.ahead(0.0);
    const auto now = follower.ahead(h);
    const auto after = follower.ahead(2.0 * h);
    if (!follower.done()) {
      ASSERT_LE(((after.x - before.x) / (2.0 * h) - now.xd).norm(), 1e-8) << i;
      ASSERT_LE(((after.xd - before.xd) / (2.0 * h) - now.xdd).norm(), 1e-6) << i;
    }
    const auto ahead = follower.ahead(4e-3);
    follower.advance(4e-3);
    ASSERT_LE((follower.ahead(0.0).x - ahead.x).norm(), 1e-14) << i;
    ASSERT_LE((follower.ahead(0.0).xd - ahead.xd).norm(), 1e-13) << i;
  }
}

/// The slowest joint determines the duration of a stop, by its acceleration bound. The path of the joints stays
/// straight.
template <typename Scheme>
void expect_to_stop(const Scheme& scheme) {
  auto tracker = panda_tracker(scheme);
  PathFollower follower(turning_circle(2.0), tracker.tip());
  for (int i = 0; i < 900; ++i) checked_tick(tracker, follower);
  const State<7> moving = tracker.state();
  const double time = follower.time();
  const Vector<7> bound = tracker.arm().limits().acceleration;
  const double quickest = (moving.qd.cwiseAbs().array() / bound.array()).maxCoeff();
  ASSERT_GT(moving.qd.norm(), 0.1);
  tracker.stop();
  for (int i = 0; i * kTick <= quickest + 2.0 * kTick; ++i) {
    EXPECT_EQ(checked_tick(tracker, follower).scale, 0.0);
    const Vector<7> displacement = tracker.state().q - moving.q;
    EXPECT_LE((displacement - displacement.norm() * moving.qd.normalized()).norm(), 1e-12);
  }
  EXPECT_EQ(tracker.state().qd.norm(), 0.0);
  EXPECT_EQ(follower.time(), time);
  const Vector<7> rest = tracker.state().q;
  for (int i = 0; i < 100; ++i) checked_tick(tracker, follower);
  EXPECT_EQ(tracker.state().q, rest);
  tracker.resume();
  for (int i = 0; i < 8000; ++i) checked_tick(tracker, follower);
  EXPECT_TRUE(follower.done());
  EXPECT_LE(tracker.tick(follower).error.norm(), 1e-9);
}
TEST(Tracker, stops_on_request_and_resumes) {
  expect_to_stop(settling());
  expect_to_stop(settling_velocity());
}

/// With an unreachable target, the arm passes the stretched, singular posture, stops at the workspace boundary,
/// and returns.
template <typename Space, typename Scheme>
void expect_to_come_back(const char* name, const Scheme& scheme) {
  for (const double forward : {0.4, 0.6, 0.9, 3.0}) {
    SCOPED_TRACE(std::string(name) + ", " + std::to_string(forward) + " m");
    auto tracker = panda_tracker<Space>(scheme);
    const auto home = Reference<Space>::hold(tracker.tip());
    auto far = moved(home, forward);
    Status worst = Status::kOk;
    for (int i = 0; i < 30000; ++i) {
      const auto tick = checked_tick(tracker, far);
      ASSERT_FALSE(failed(tick.status));
      worst = worse(worst, tick.status);
      if (i > 29000) {
        ASSERT_LE(tick.qd.norm(), 2e-3) << i;
        ASSERT_LE(tick.qdd.norm(), 2e-3) << i;
      }
    }
    EXPECT_NE(worst, Status::kOk);
    const double short_of = tracker.tick(far).error.norm();
    EXPECT_GT(short_of, forward - 0.4);
    for (int i = 0; i < 8000; ++i) checked_tick(tracker, home);
    EXPECT_LE(tracker.tick(home).error.norm(), 1e-9);
    EXPECT_LE(tracker.state().qd.norm(), 1e-3);
    EXPECT_EQ(tracker.tick(home).status, Status::kOk);
  }
}
TEST(Tracker, stops_at_the_workspace_boundary_and_returns) {
  expect_to_come_back<Pose>("FPBM, pose", settling());
  expect_to_come_back<Position<3>>("FPBM, position", settling<kOpen>());
  expect_to_come_back<Pose>("MVN, pose", settling_velocity());
  expect_to_come_back<Position<3>>("MVN, position", settling_velocity<kOpen>());
}

/// If limits admit only a small part of the desired acceleration of a stiff feedback, the result for a measured state
/// still changes smoothly: accelerations rarely alternate.
TEST(Tracker, does_not_chatter_beyond_the_workspace_boundary) {
  const Vector<7> weights = (Vector<7>() << 8, 8, 4, 4, 2, 1, 1).finished();
  const auto z = NullSpace<7>{}.with_damping(10.0).with_rest_posture(bent(), 25.0);
  const auto stiff = FPBM<7>(0.6, DiagonalWeights<7>(weights), 60.0, 900.0, z);
  auto bounds = panda().limits();
  bounds.upper(3) = -0.47;  // The stretched elbow must not bend in the other direction.
  const Limits<Level::kAcceleration, 7> limits(bounds, kTick);
  for (const Vector<3>& leap : {Vector<3>(0.5, 0, 0), Vector<3>(0.5, 0.1, 0), Vector<3>(-0.4, 0, -0.3),
                                Vector<3>(-0.4, 0.1, -0.3), Vector<3>(0, 0, 0.6)}) {
    CompiledTracker tracker(panda(), Pose{}, stiff, {bent(), Vector<7>::Zero()}, {}, limits);
    const auto home = Reference<Pose>::hold(tracker.tip());
    auto away = home;
    away.x.p += leap;
    State<7> state = tracker.state();
    Vector<7> last = Vector<7>::Zero();
    Vector<7> jump = Vector<7>::Zero();
    int reversals = 0;
    for (int i = 0; i < 8000; ++i) {
      const auto tick = tracker.resolve_measured(state.q, state.qd, i < 4000 ? away : home);
      const Vector<7> next = tick.qdd - last;
      const auto to_and_fro =
          (jump.array() * next.array() < 0.0).select(jump.cwiseAbs().cwiseMin(next.cwiseAbs()), 0.0);
      reversals += to_and_fro.maxCoeff() > 2.0 ? 1 : 0;  // [rad/s²]
      last = tick.qdd;
      jump = next;
      state.q += kTick * (state.qd + kTick / 2.0 * tick.qdd);
      state.qd += kTick * tick.qdd;
    }
    EXPECT_LE(reversals, 10) << leap.transpose();
    EXPECT_LE(tracker.resolve_measured(state.q, state.qd, home).error.norm(), 1e-6);
  }
}

/// For an exact measured state, the result equals the result of the scheme if no limit is near, and is within the box
/// otherwise. The state of the tracker does not change.
TEST(Tracker, resolves_a_measured_state) {
  TrackerOptions<> exact;
  exact.measured_delay = 0;
  auto tracker = panda_tracker(settling(), exact);
  const auto home = Reference<Pose>::hold(tracker.tip());
  const Limits<Level::kAcceleration, 7> limits(panda().limits(), kTick);
  Random random(11);
  int plain = 0;
  for (int i = 0; i < 2000; ++i) {
    const State<7> state{bent() + random.uniform(7, -0.2, 0.2), random.uniform(7, -1.5, 1.5)};
    const auto target = moved(home, random.uniform(-0.1, 0.1));
    const auto tick = tracker.resolve_measured(state.q, state.qd, target);
    const Kinematics<Pose, 7> kinematics = kinematics_of(panda(), state);
    Vector<7> qdd = Vector<7>::Zero();
    auto scheme = settling();
    scheme.singular = SingularDamping<>();
    const Vector<6> error = Pose::difference<double>(target.x, kinematics.tip);
    auto near = target;
    Vector<6> seen = error;  // The feedback is bounded to a tenth of the arm length, and to 0.1 rad.
    seen.head<3>() *= std::min(1.0, 0.1 * kinematics.length / error.head<3>().norm());
    seen.tail<3>() *= std::min(1.0, 0.1 / error.tail<3>().norm());
    near.x = Pose::displace<double>(kinematics.tip, seen);
    ASSERT_FALSE(failed(resolve(scheme, kinematics, near, state, qdd)));
    const auto box = limits.box(state);
    ASSERT_TRUE(box.contains(tick.qdd));
    if (box.contains(qdd)) {
      ASSERT_LE((tick.qdd - qdd).norm(), 1e-12 * qdd.norm());
      ++plain;
    } else {
      ASSERT_NE(tick.saturated, 0U);
      if (tick.scale == 1.0) {
        ASSERT_LE((kinematics.J * (tick.qdd - qdd)).norm(), 1e-9);
      }
    }
  }
  EXPECT_GT(plain, 100);
  EXPECT_LT(plain, 1900);
  EXPECT_EQ(tracker.state().q, bent());

  const auto lost = tracker.resolve_measured(Vector<7>::Constant(kNan), Vector<7>::Zero(), home);
  EXPECT_EQ(lost.status, Status::kNotFinite);
  EXPECT_EQ(lost.qdd, Vector<7>(Vector<7>::Zero()));
}

/// The integral removes the steady-state error of a constant disturbance, and does not wind up.
TEST(Tracker, removes_the_error_of_a_constant_bias) {
  Vector<7> bias;
  bias << 0.3, -0.2, 0.1, 0.4, -0.3, 0.2, 0.1;
  const auto steady_error = [&](double gain, int ticks, double blocked_until) {
    auto tracker = panda_tracker(settling(), {kTick, 0.1, gain, 2.0});
    const auto home = Reference<Pose>::hold(tracker.tip());
    State<7> state = tracker.state();
    double error = 0.0;
    for (int i = 0; i < ticks; ++i) {
      const bool blocked = i * kTick < blocked_until;
      const auto tick = tracker.resolve_measured(state.q, state.qd, blocked ? moved(home, 0.08) : home);
      if (blocked) continue;  // The arm is blocked.
      state.q += kTick * state.qd;
      state.qd += kTick * (tick.qdd + bias);
      error = tick.error.norm();
    }
    return error;
  };
  EXPECT_GT(steady_error(0.0, 8000, 0.0), 1e-3);
  EXPECT_LE(steady_error(50.0, 15000, 0.0), 1e-6);
  EXPECT_LE(steady_error(50.0, 115000, 100.0), 1e-6);
}

/// While the reference is not finite, the arm brakes, and the status reports the reason. Afterwards, the arm continues.
template <typename Scheme>
void expect_to_brake_on_nonsense(const Scheme& scheme) {
  auto tracker = panda_tracker(scheme);
  const auto home = Reference<Pose>::hold(tracker.tip());
  auto target = moved(home, 0.05);
  for (int i = 0; i < 100; ++i) checked_tick(tracker, target);
  ASSERT_GT(tracker.state().qd.norm(), 1e-2);
  for (const double nonsense : {kNan, std::numeric_limits<double>::infinity(), 1e308}) {
    auto bad = target;
    bad.xd(2) = nonsense;
    bad.xdd(1) = nonsense;
    for (int i = 0; i < 300; ++i) {
      const auto tick = checked_tick(tracker, bad);
      ASSERT_TRUE(tick.q.allFinite() && tick.qd.allFinite() && tick.qdd.allFinite());
    }
    if (nonsense != 1e308) {
      EXPECT_EQ(tracker.tick(bad).status, Status::kNotFinite);
      EXPECT_EQ(tracker.state().qd.norm(), 0.0);
      EXPECT_FALSE(failed(tracker.tick(target).status)) << "the next tick has a good reference";
    }
  }
  for (int i = 0; i < 6000; ++i) checked_tick(tracker, home);
  EXPECT_LE(tracker.tick(home).error.norm(), 1e-9);
}
TEST(Tracker, brakes_where_the_reference_is_not_finite) {
  expect_to_brake_on_nonsense(settling());
  expect_to_brake_on_nonsense(settling_velocity());
}

/// An hour at rest on a target after a motion.
TEST(Tracker, holds_at_rest_for_an_hour) {
  const auto z = NullSpace<4>{}.with_damping(2.0);
  const auto scheme = FPBM<4>(0.6, DiagonalWeights<4>(Vector<4>(1, 2, 3, 4)), 4.0, 4.0, z);
  CompiledTracker tracker(PlanarArm<4>(Vector<4>::Ones()), Position<2>{}, scheme, Vector<4>(0.3, 0.8, -0.5, 0.6));
  PathFollower follower(AnyPath<Position<2>>(Path(Circle(0.3), 5.0)), tracker.tip());
  for (int i = 0; i < 65000; ++i) tracker.tick(follower);
  const Vector<4> start = tracker.state().q;
  double fastest = 0.0;
  for (int i = 0; i < trials(3600000); ++i)
    fastest = std::max(fastest, tracker.tick(follower).qd.cwiseAbs().maxCoeff());
  EXPECT_LE(fastest, 1e-9);
  EXPECT_LE((tracker.state().q - start).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Tracker, names_the_invalid_argument) {
  const auto make = [](const TrackerOptions<>& options) {
    return complaint([&] { (void)panda_tracker(settling(), options); });
  };
  EXPECT_EQ(make({}), "");
  EXPECT_EQ(make({0.0}), "dt = 0: must be positive and finite");
  EXPECT_EQ(make({kTick, -1.0}), "error_bound = -1: must be positive and finite");
  EXPECT_EQ(make({kTick, 0.1, -1.0}), "integral_gain = -1: must be finite and not negative");
  EXPECT_EQ(make({kTick, 0.1, 1.0, 0.0}), "integral_bound = 0: must be positive and finite");
  Vector<7> q0 = bent();
  q0(3) = 0.5;
  EXPECT_EQ(complaint([&] { CompiledTracker(panda(), Pose{}, settling(), q0); }),
            "q0[3] = 0.5: must be within the joint's range, from -3.0718 to -0.0698, or give recover_start = true, "
            "with which the joint returns");
  Chain<> chain = panda_without_jerk();
  for (Joint<>& joint : chain.joints) joint.bounds.acceleration = JointBounds<>::kNone;
  const SerialArm<7> unbounded(chain);
  EXPECT_EQ(complaint([&] { CompiledTracker(unbounded, Pose{}, settling(), bent()); }),
            "limits.acceleration[0] = inf: must be finite if the joint position or velocity is bounded: give a bound");
  EXPECT_EQ(complaint([] { PathFollower(circle(), Vector<3>(0, 0, 0), 0.0); }),
            "ramp = 0: must be positive and finite");
  const Limits<Level::kAcceleration, 7> slower(panda().limits(), 2e-3);
  EXPECT_EQ(
      complaint([&] {
        CompiledTracker(panda(), Pose{}, settling(), State<7>{bent(), Vector<7>::Zero()}, TrackerOptions<>{}, slower);
      }),
      "limits' tick = 0.002: must be the tracker's dt = 0.001");
}

}  // namespace
}  // namespace fpbm::test::tracker_laws
