#include "fpbm/simulate/kept_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fpbm/bound/preset_capsules.hpp"
#include "fpbm/bound/torque_bounds.hpp"
#include "fpbm/model/dynamics.hpp"
#include "fpbm/model/presets.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/path/placed.hpp"
#include "fpbm/path/waypoints.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/pose_task.hpp"
#include "support/random.hpp"

/// kept_path(): the tip stays on the path while an operator changes the speed, and no bound is exceeded by differences.
namespace fpbm::test::kept_path_laws {
namespace {

using Arm = SerialArm<7>;
using JointVector = Vector<7>;
constexpr double kFree = std::numeric_limits<double>::infinity();
const FastestOptions kOptions{1e-3, kFree, kFree, 0.05};
/// Largest error [m, rad]. Of 900 random motions at velocity level, 1.4e-7. At acceleration level, the feedback
/// corrects errors of the third order of a tick.
template <typename Scheme>
constexpr double kOnPath = Scheme::kLevel == Level::kVelocity ? 1e-6 : 1e-5;

/// Calls f(scheme) for a scheme at each level.
template <typename F>
void at_both_levels(F&& f) {
  f(MVN<7>(5.0));
  f(FPBM<7>(0.6, JointVector{4.0, 3.0, 2.0, 2.0, 1.0, 1.0, 1.0}, 10.0, 25.0));
}

const Arm& panda() {
  static const Arm arm(presets::panda());
  return arm;
}
const JointVector kBent{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};

auto circle(double duration) {
  return WithRotation(InPlane(Path(Circle(0.15), duration, Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}));
}

TrackerOptions<> options_of(bool keep_first_level) {
  TrackerOptions<> options;
  options.singular = SingularDamping<>::off();
  options.keep_first_level = keep_first_level;
  return options;
}

template <typename Scheme, typename Bounds_ = Bounds<>>
auto tracker_of(const Scheme& scheme, const JointVector& q0, bool keep_first_level = true, const Bounds_& bounds = {}) {
  const auto options = options_of(keep_first_level);
  return Tracker<Arm, Pose, Scheme, Bounds_>(panda(), Pose{}, scheme, State<7>{q0, JointVector::Zero()}, options,
                                             Limits<Scheme::kLevel, 7>(panda().limits(), options.dt),
                                             JointVector::Zero(), bounds);
}

/// A motion of a tracker along a kept path, tick by tick.
struct Ride {
  double error = 0.0;           ///< Largest error [m, rad].
  double ratio = 0.0;           ///< Largest ratio of a velocity, acceleration or jerk to its bound, by differences.
  double least_step = kFree;    ///< Least step of the clock [s].
  double least_fraction = 1.0;  ///< Least Tick::path_fraction.
  Status worst = Status::kOk;
  int ticks = 0;
  bool done = false;
};

/// Ticks until the path ends. each_tick(k): called before tick k.
template <typename Tracker_, typename Follower, typename EachTick>
Ride ride(Tracker_& tracker, Follower& follower, EachTick each_tick, int most = 40000) {
  constexpr double kTick = 1e-3;
  const auto limits = tracker.arm().limits().complete();
  Ride ride;
  JointVector q = tracker.state().q;
  JointVector v = JointVector::Zero();
  JointVector a = JointVector::Zero();
  for (; ride.ticks < most && !follower.done(); ++ride.ticks) {
    each_tick(ride.ticks);
    const double before = follower.time();
    const auto tick = tracker.tick(follower);
    ride.least_step = std::min(ride.least_step, follower.time() - before);
    ride.least_fraction = std::min(ride.least_fraction, tick.path_fraction);
    ride.error = std::max(ride.error, tick.error.cwiseAbs().maxCoeff());
    ride.worst = worse(ride.worst, tick.status);
    const JointVector next_v = Tracker_::kLevel == Level::kVelocity ? JointVector((tick.q - q) / kTick) : tick.qd;
    const JointVector next_a = (next_v - v) / kTick;
    const JointVector jerk = (next_a - a) / kTick;
    const auto ratio = [](const JointVector& x, const JointVector& bound) {
      return x.cwiseAbs().cwiseQuotient(bound).maxCoeff();
    };
    ride.ratio = std::max(
        {ride.ratio, ratio(next_v, limits.velocity), ratio(next_a, limits.acceleration), ratio(jerk, limits.jerk)});
    q = tick.q;
    v = next_v;
    a = next_a;
  }
  ride.done = follower.done();
  return ride;
}

const auto kNothing = [](int) {};

/// Velocity of the tip.
template <typename Tracker_>
Vector<6> tip_velocity(const Tracker_& tracker) {
  Kinematics<Pose, 7> kinematics;
  tracker.arm().kinematics(tracker.state().q, kinematics);
  return kinematics.J * tracker.state().qd;
}

/// Changes the speed of a follower, and pauses and stops, at random moments.
template <typename Tracker_, typename Follower>
auto operator_of(Random& random, Tracker_& tracker, Follower& follower) {
  return [&random, &tracker, &follower, next = 100](int k) mutable {
    if (k % 5000 == 4999) {  // The motion ends.
      tracker.resume();
      follower.resume();
      follower.set_speed(1.0);
    }
    if (k < next) return;
    next = k + static_cast<int>(random.uniform(20.0, 500.0));
    switch (static_cast<int>(random.uniform(0.0, 6.0))) {
      case 0: follower.set_speed(random.uniform(0.05, 1.0)); break;
      case 1: follower.pause(); break;
      case 2: follower.resume(); break;
      case 3: tracker.stop(); break;
      case 4: tracker.resume(); break;
      default: follower.set_speed(1.0); follower.resume();
    }
  };
}

TEST(KeptPath, is_kept_by_a_tracker_that_would_leave_it) {
  Bounds<> none;
  at_both_levels([&](const auto& scheme) {
    constexpr double kError = kOnPath<std::decay_t<decltype(scheme)>>;
    for (const double duration : {2.0, 1.5, 1.2, 1.0, 0.5}) {
      const auto path = circle(duration);
      auto tracker = tracker_of(scheme, kBent);
      const auto kept = kept_path(panda(), path, tracker.scheme(), kBent, panda().limits(), none, kOptions);
      PathFollower follower(kept, tracker.tip());
      const Ride found = ride(tracker, follower, kNothing);
      EXPECT_TRUE(found.done);
      EXPECT_EQ(found.worst, Status::kOk);
      EXPECT_LE(found.error, kError);
      EXPECT_LE(found.ratio, 1.0 + 1e-9);
      EXPECT_NEAR(kept.duration(), std::max(duration, 1.252), 3e-3);
      EXPECT_NEAR(found.ticks * 1e-3, kept.duration(), 1.5e-3);
      auto hurried = tracker_of(scheme, kBent);
      PathFollower plain(path, hurried.tip());
      EXPECT_EQ(ride(hurried, plain, kNothing).error > 0.01, duration < 1.8) << duration;
    }
  });
}

TEST(KeptPath, is_kept_while_an_operator_changes_the_speed) {
  Bounds<> none;
  at_both_levels([&](const auto& scheme) {
    constexpr double kError = kOnPath<std::decay_t<decltype(scheme)>>;
    Random random(7);
    int done = 0;
    for (int tried = 0; done < 6 && tried < 60; ++tried) {
      JointVector q0;
      const auto& limits = panda().limits();
      for (int i = 0; i < 7; ++i) {
        q0(i) = limits.lower(i) + (limits.upper(i) - limits.lower(i)) * random.uniform(0.3, 0.7);
      }
      std::vector<Transform<>> points(1);
      for (int i = 0; i < 3; ++i) {
        points.push_back(points.back());
        points.back().p += Vector<3>(random.uniform(3, -0.15, 0.15));
      }
      const auto path = Waypoints<Pose>::lasting(points, 0.3);
      try {
        auto tracker = tracker_of(scheme, q0);
        const auto kept = kept_path(panda(), path, tracker.scheme(), q0, limits, none, kOptions);
        PathFollower follower(kept, tracker.tip(), random.uniform(0.01, 0.5));
        const Ride found = ride(tracker, follower, operator_of(random, tracker, follower));
        ++done;
        EXPECT_TRUE(found.done);
        EXPECT_LE(found.error, 10 * kError);
        EXPECT_LE(found.ratio, 1.0 + 1e-9);
        EXPECT_GE(found.least_step, 0.0) << "the clock never runs backward";
      } catch (const std::invalid_argument&) {
        continue;  // The path leaves the workspace, or a joint its range.
      }
    }
    EXPECT_EQ(done, 6);
  });
}

TEST(KeptPath, is_kept_at_the_edge_of_the_torques) {
  const auto scheme = FPBM<7>(0.6, JointVector{4.0, 3.0, 2.0, 2.0, 1.0, 1.0, 1.0}, 10.0, 25.0);
  const Chain<> chain = presets::panda();
  Dynamics<7> dynamics(chain);
  ASSERT_TRUE(dynamics.set_payload(Robot<7>::kTip, {3.0, {0.0, 0.0, 0.15}}));
  Random random(3);
  // At the second place, the tracker cannot stop everywhere from the fastest motion.
  const JointVector far{0.0, 0.6, 0.0, -1.6, 0.0, 2.2, 0.785};
  for (const auto& [q0, fraction] : {std::pair(kBent, 0.55), std::pair(far, 0.86)}) {
    Bounds bounds(TorqueBounds<7>(chain, dynamics, fraction * panda().limits().effort));
    auto tracker = tracker_of(scheme, q0, true, bounds);
    const auto kept = kept_path(panda(), circle(0.5), tracker.scheme(), q0, panda().limits(), bounds, kOptions);
    for (const bool operated : {false, true}) {
      auto own = tracker_of(scheme, q0, true, bounds);
      PathFollower follower(kept, own.tip());
      const Ride found =
          operated ? ride(own, follower, operator_of(random, own, follower)) : ride(own, follower, kNothing);
      EXPECT_TRUE(found.done);
      EXPECT_LE(found.error, 1e-5);
      EXPECT_LE(found.ratio, 1.0 + 1e-9);
      EXPECT_NE(found.worst, Status::kBlocked);
    }
  }
}

/// A path with another motion.
template <typename Path>
struct WithMotion {
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;
  Path path;
  const KeptMotion* other;
  [[nodiscard]] const KeptMotion* motion() const noexcept { return other; }
  [[nodiscard]] double duration() const noexcept { return path.duration(); }
  [[nodiscard]] Reference<Space> sample(double t) const noexcept { return path.sample(t); }
};

/// Without a reserve, a ramp of any length needs more acceleration than there is: the tracker changes the rate of the
/// clock as fast as the limits allow.
TEST(KeptPath, is_kept_by_a_clock_that_changes_as_fast_as_the_limits_allow) {
  Bounds<> none;
  at_both_levels([&](const auto& scheme) {
    constexpr double kError = kOnPath<std::decay_t<decltype(scheme)>>;
    double least = 1.0;
    for (const double reserve : {0.02, 0.05, 0.2}) {
      FastestOptions options = kOptions;
      options.reserve = reserve;
      auto tracker = tracker_of(scheme, kBent);
      const auto kept = kept_path(panda(), circle(0.5), tracker.scheme(), kBent, panda().limits(), none, options);
      KeptMotion abrupt = *kept.motion();
      abrupt.ramp = 0.05;
      PathFollower follower(WithMotion<std::decay_t<decltype(kept)>>{kept, &abrupt}, tracker.tip(), 0.05);
      const Ride found = ride(tracker, follower, [&](int k) {
        if (k == 600) follower.set_speed(0.4);
      });
      EXPECT_TRUE(found.done);
      EXPECT_LE(found.error, kError);
      least = std::min(least, found.least_fraction);
      EXPECT_LE(found.ratio, 1.0 + 1e-9);
    }
    EXPECT_LT(least, 1.0);
  });
}

TEST(KeptPath, begins_with_a_joint_on_a_bound) {
  Bounds<> none;
  at_both_levels([&](const auto& scheme) {
    for (const bool upper : {true, false}) {
      JointVector q0 = kBent;
      q0(6) = upper ? panda().limits().upper(6) : panda().limits().lower(6);
      const auto path = InPlane(Path(Circle(0.1), 0.5, Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0});
      Tracker tracker(panda(), Position<3>{}, scheme, q0, options_of(true));
      const auto kept = kept_path(panda(), path, tracker.scheme(), q0, panda().limits(), none, kOptions);
      PathFollower follower(kept, tracker.tip());
      const Ride found = ride(tracker, follower, kNothing);
      EXPECT_TRUE(found.done);
      EXPECT_LE(found.error, kOnPath<std::decay_t<decltype(scheme)>>);
      EXPECT_LE(found.ratio, 1.0 + 1e-9);
    }
  });
}

TEST(KeptPath, stops_on_the_path_with_keep_first_level) {
  Bounds<> none;
  at_both_levels([&](const auto& scheme) {
    constexpr double kError = kOnPath<std::decay_t<decltype(scheme)>>;
    double errors[2];
    double ramp = 0.0;
    int until_rest[2];
    for (const bool keeps : {true, false}) {
      auto tracker = tracker_of(scheme, kBent, keeps);
      const auto kept = kept_path(panda(), circle(0.5), tracker.scheme(), kBent, panda().limits(), none, kOptions);
      ramp = kept.motion()->ramp;
      PathFollower follower(kept, tracker.tip());
      int rest = 0;
      const Ride found = ride(tracker, follower, [&](int k) {
        if (k == 500) tracker.stop();
        if (k > 500 && rest == 0 && tip_velocity(tracker).isZero(1e-5)) rest = k - 500;
        if (k == 2500) tracker.resume();
      });
      EXPECT_TRUE(found.done);
      EXPECT_LE(found.ratio, 1.0 + 1e-9);
      errors[keeps ? 0 : 1] = found.error;
      until_rest[keeps ? 0 : 1] = rest;
    }
    EXPECT_LE(errors[0], kError);
    EXPECT_GT(errors[1], 1e-4) << "joints that stop in the least time leave the path";
    EXPECT_GT(until_rest[1], 0);
    EXPECT_LE(until_rest[1], until_rest[0]);
    EXPECT_LE(until_rest[0], 1000 * ramp + 2);
  });
}

TEST(KeptPath, waits_on_the_path_before_an_obstacle_and_continues_when_the_obstacle_leaves) {
  using Shapes7 = Clearance<7>;
  const Vector<3> far{0.0, 0.0, 5.0};
  const auto ball = [](const Vector<3>& at) { return WorldShape<>(Capsule<>{at, at, 0.05}); };
  const Shapes7 clearance(presets::panda(), presets::capsules::panda(), {Obstacle<>{"ball", ball(far)}}, 0.01,
                          {{"panda_link7", "panda_link5"}});
  at_both_levels([&](const auto& scheme) {
    for (const double side : {-1.0, 1.0}) {
      Bounds bounds(clearance);
      const Path line(Line<3>(Vector<3>{0.0, 0.35 * side, 0.0}), 0.3, Quintic{});
      auto tracker = tracker_of(scheme, kBent, true, bounds);
      const auto kept =
          kept_path(panda(), WithRotation(line), tracker.scheme(), kBent, panda().limits(), bounds, kOptions);
      const Vector<3> ahead = tracker.tip().p + Vector<3>{0.0, 0.4 * side, 0.0};
      PathFollower follower(kept, tracker.tip());
      double nearest = kFree;
      int still = 0;
      auto& shapes = tracker.bounds().template get<Shapes7>();
      const Ride found = ride(tracker, follower, [&](int k) {
        if (k == 50) shapes.move(0, ball(ahead), Vector<3>::Zero());
        if (k == 3000) shapes.move(0, ball(far), Vector<3>::Zero());
        nearest = std::min(nearest, shapes.nearest_pair(tracker.state().q).second);
        if (k < 3000 && k > 100 && tracker.state().qd.isZero(1e-3)) ++still;
      });
      EXPECT_TRUE(found.done);
      EXPECT_GT(still, 1000) << "the arm waits";
      // At acceleration level, a tick in which no rate of the clock is possible leaves an error of the velocity, which
      // the feedback removes slowly.
      EXPECT_LE(found.error, tracker.kLevel == Level::kVelocity ? 1e-4 : 2e-3);
      EXPECT_LE(found.ratio, 1.0 + 1e-9);
      EXPECT_GE(nearest, 0.01);
    }
  });
}

TEST(KeptPath, has_a_null_space_motion_for_the_duration_of_the_motion) {
  Bounds<> none;
  auto scheme = MVN<7>(5.0);
  scheme.null_space = NullSpace<7>().with_joint_centring(panda().limits(), 2.0);
  const auto kept = kept_path(panda(), circle(0.5), scheme, kBent, panda().limits(), none, kOptions);
  Tracker tracker(panda(), Pose{}, scheme, kBent, options_of(true));
  PathFollower follower(kept, tracker.tip());
  const Ride found = ride(tracker, follower, kNothing);
  EXPECT_TRUE(found.done);
  EXPECT_LE(found.error, kOnPath<VelocityScheme<7>>);
  const JointVector planned = kept.motion()->posture<7>(kept.duration());
  EXPECT_LE((tracker.state().q - planned).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(KeptPath, has_a_constant_speed_where_the_joints_allow_it) {
  Bounds<> none;
  FastestOptions options = kOptions;
  options.tip_speed = 0.1;
  const auto kept = kept_path(panda(), circle(0.5), MVN<7>(5.0), kBent, panda().limits(), none, options);
  EXPECT_NEAR(kept.duration(), 2.0 * 3.14159265 * 0.15 / 0.1, 0.2);
  auto tracker = tracker_of(MVN<7>(5.0), kBent);
  PathFollower follower(kept, tracker.tip());
  Vector<3> last = tracker.tip().p;
  int steady = 0;
  double fastest = 0.0;
  const Ride found = ride(tracker, follower, [&](int) {
    const double speed = (tracker.tip().p - last).norm() / 1e-3;
    last = tracker.tip().p;
    fastest = std::max(fastest, speed);
    if (std::abs(speed - 0.1) < 1e-3) ++steady;
  });
  EXPECT_LE(found.error, kOnPath<VelocityScheme<7>>);
  EXPECT_LE(fastest, 0.1 * (1.0 + 1e-6));
  EXPECT_GE(steady, 0.95 * found.ticks);
}

TEST(KeptPath, throws_where_the_arm_cannot_follow) {
  Bounds<> none;
  const auto planned = [&](double radius, const FastestOptions& options) {
    const auto path = WithRotation(InPlane(Path(Circle(radius), 1.0, Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}));
    return kept_path(panda(), path, MVN<7>(5.0), kBent, panda().limits(), none, options);
  };
  const auto message_of = [&](double radius, const FastestOptions& options) -> std::string {
    try {
      (void)planned(radius, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message_of(0.6, kOptions).find("can be followed to the fraction 0."), std::string::npos);
  FastestOptions wrong = kOptions;
  wrong.reserve = -0.1;
  EXPECT_NE(message_of(0.1, wrong).find("reserve = -0.1"), std::string::npos);
  EXPECT_EQ(message_of(0.1, kOptions), "");
}

TEST(TrackerSpeed, is_the_speed_of_followers_and_filters) {
  auto tracker = tracker_of(MVN<7>(5.0), kBent);
  for (const double wrong : {0.0, -0.5, 1.1, std::nan("")}) EXPECT_FALSE(tracker.set_speed(wrong));
  PathFollower follower(circle(2.0), tracker.tip(), 0.1);
  TargetFilter<Pose> filter(tracker.tip(), {0.5, 1.0, 10.0, 1.0, 2.0, 20.0});
  follower.set_speed(0.7);
  (void)tracker.tick(follower);
  EXPECT_EQ(follower.speed(), 0.7) << "without set_speed(), sources have their own speed";
  EXPECT_TRUE(tracker.set_speed(0.25));
  (void)tracker.tick(follower);
  (void)tracker.tick(filter);
  EXPECT_EQ(follower.speed(), 0.25);
  EXPECT_EQ(filter.speed(), 0.25);
}

}  // namespace
}  // namespace fpbm::test::kept_path_laws
