#include "support/allocation_watch.hpp"  // Before all headers that include Eigen.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "fpbm/any/any_scheme.hpp"
#include "fpbm/core/lanes.hpp"
#include "fpbm/inverse/inverse_kinematics.hpp"
#include "fpbm/limits/level_saturation.hpp"
#include "fpbm/model/dynamics.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/simulate/kept_path.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/schemes.hpp"

/// Rollouts and control loops allocate nothing, for every scheme and number of joints. Three watches count allocations.
/// Each watch must detect a planted allocation.
namespace fpbm::test {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr int kSteps = 100;

struct Watched {
  Status status;
  int samples;
  AllocationCount count;
};

/// A rollout under watch, with buffers of the caller. `extra` is called at every sample.
template <typename Space, typename Arm, typename Scheme>
Watched watched_rollout(const Arm& arm, const AnyPath<Space>& path, const Scheme& scheme, const Vector<Arm::kDof>& q0,
                        void (*extra)()) {
  constexpr int N = Arm::kDof;
  static std::array<double, kMaxDof*(kSteps + 1)> q;
  static std::array<double, 16 * (kSteps + 1)> x;
  MotionBuffers<Space, N> buffers;
  buffers.q = q.data();
  buffers.x = x.data();
  const State<N> start{q0, Vector<N>::Zero(q0.size())};
  const TimeGrid<> grid(path.duration(), 2.0 * path.duration() / kSteps, path.duration());

  const AllocationWatch watch;
  const auto result = rollout(arm, path, scheme, start, grid, [&](const auto& sample) {
    buffers(sample);
    extra();
  });
  return {result.status, result.samples, watch.count()};
}

void expect_none(const Watched& watched, const std::string& name) {
  EXPECT_FALSE(failed(watched.status)) << name;
  EXPECT_EQ(watched.samples, kSteps + 1) << name;
  EXPECT_EQ(watched.count.by_new, 0) << name;
  EXPECT_EQ(watched.count.by_malloc, 0) << name;
  EXPECT_EQ(watched.count.by_eigen, 0) << name;
}

template <typename Scheme>
Watched on_the_papers_circle(
    const Scheme& scheme, void (*extra)() = [] {}) {
  return watched_rollout(paper_arm(), paper_circle(), scheme, paper_start().q, extra);
}

/// Uses AnyScheme: the rollout is compiled once for each level, and the scheme for its own size.
template <typename Scheme>
void expect_none_in(const Scheme& scheme, const std::string& name) {
  const AnyScheme<Scheme::kLevel, Position<2>> any(scheme);
  const Vector<kOpen> q0 = paper_start().q;
  expect_none(watched_rollout(any_planar_arm(Vector<4>::Ones()), paper_circle(), any, q0, [] {}), name);
}

template <int N>
void expect_none_in_any_scheme() {
  Law law;
  law.alpha = 0.6;
  law.k = law.k1 = law.k2 = 1.0;
  law.damping = law.stiffness = 1.0;
  law.q_rest = law.c = Vector<4>::Zero();
  for_every_scheme<N>([&](const std::string& name, const Takes& takes, const auto& make) {
    law.W = Vector<4>(1, 2, 3, 4).asDiagonal();
    if (takes.dense) law.W += 0.2 * Matrix<4, 4>::Ones();
    for (const bool with_z : {false, true}) {
      law.has_null_space = with_z;
      expect_none_in(make(law), name + (with_z ? " with z" : ""));
    }
  });
}

TEST(NoAllocation, in_a_rollout_of_a_fixed_size) {
  expect_none_in_any_scheme<4>();
  expect_none(on_the_papers_circle(paper_fpbm()), "FPBM");
  expect_none(on_the_papers_circle(MVN<4>(1.0)), "MVN");
}
TEST(NoAllocation, in_a_rollout_of_a_size_chosen_at_run_time) {
  expect_none_in_any_scheme<kOpen>();
}

/// A secondary objective that wraps a scheme.
template <typename Arm>
void expect_none_in_an_ascent(const Arm& arm) {
  constexpr int N = Arm::kDof;
  const auto scheme = FPBM<N>(0.6, Vector<N>(Vector<4>::Ones()), 1.0, 1.0, NullSpace<N>{}.with_damping(2.0));
  expect_none_in(ManipulabilityAscent(scheme, arm, 0.1), "at acceleration level");
  expect_none_in(ManipulabilityAscent(MVN<N>(1.0), arm, 0.1), "at velocity level");
}
TEST(NoAllocation, in_secondary_objectives) {
  expect_none_in_an_ascent(paper_arm());
  expect_none_in_an_ascent(any_planar_arm(Vector<4>::Ones()));
}

/// Schemes with the dynamics of the arm of the paper.
template <int N>
void expect_none_with_dynamics() {
  Chain<> chain;
  for (int i = 0; i < 4; ++i) {
    chain.joints.push_back({});
    chain.joints.back().placement.p = {i > 0 ? 1.0 : 0.0, 0.0, 0.0};
    chain.joints.back().moved = {1.0, {0.5, 0.0, 0.0}, Matrix<3, 3>::Identity() / 12.0};
  }
  const Dynamics<N> model(chain);
  const auto z = NullSpace<N>{}.with_damping(2.0);
  expect_none_in(BalancedTorque(model, 0.95, Vector<N>(Vector<4>::Ones()), 1.0, 1.0, z), "torque");
  expect_none_in(MinimumEnergy(model, 1.0), "energy");
}
TEST(NoAllocation, in_schemes_with_dynamics) {
  expect_none_with_dynamics<4>();
  expect_none_with_dynamics<kOpen>();
}

[[nodiscard]] Vector<kOpen> panda_ready() {
  return Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
}

/// Arms in space, poses, and all types of paths. Waypoints allocate when they are constructed.
TEST(NoAllocation, in_space) {
  using Accelerations = AnyScheme<Level::kAcceleration, Pose>;
  const InPlane circle(Path(Circle(0.05), 5.0), Vector<3>::UnitY(), Vector<3>::UnitZ());
  const std::vector<Transform<>> points{{}, {{0.05, 0.0, 0.05}, rotation(Vector<3>(0.1, 0.2, 0.0))}, {{0.1, 0.0, 0.0}}};
  const AnyPath<Pose> path(
      Sequence(WithRotation(circle, Vector<3>(0.1, 0.2, 0.3)), Waypoints<Pose>::lasting(points, 5.0)));
  const Accelerations fixed(FPBM<7>(0.6, Vector<7>(Vector<7>::Ones()), 10.0, 25.0));
  const AnyArm<Position<3>> panda{SerialArm<7>(presets::panda())};
  expect_none(watched_rollout(panda, path, fixed, panda_ready(), [] {}), "Panda");

  Chain<> chain = presets::panda();
  chain.joints.insert(chain.joints.begin(), Joint<>{JointType::kPrismatic});
  chain.joints[0].mimic = {1, 0.1, 0.0};
  const Accelerations open(FPBM<kOpen>(0.6, Vector<kOpen>(Vector<7>::Ones()), 10.0, 25.0));
  expect_none(watched_rollout(any_arm(chain), path, open, panda_ready(), [] {}), "Panda, coupled");
}

/// All calls of a control loop, with reachable targets, references that violate all limits, and NaN.
template <typename Space, typename Arm, typename Scheme, typename Bounds_ = Bounds<>>
void expect_none_in_a_loop(const Arm& arm, const Scheme& scheme, const Bounds_& bounds = {}) {
  constexpr int N = Arm::kDof;
  const Vector<N> q0 = panda_ready();
  TrackerOptions<> options;
  options.integral_gain = 1.0;
  Tracker<Arm, Space, Scheme, Bounds_> tracker(arm, Space{}, scheme, State<N>{q0, Vector<N>::Zero(7)}, options,
                                               Limits<Scheme::kLevel, N>(arm.limits(), options.dt), Vector<N>::Zero(7),
                                               bounds);
  const auto home = Reference<Space>::hold(tracker.tip());
  const InPlane circle(Path(Circle(0.05), 0.5), Vector<3>::UnitY(), Vector<3>::UnitZ());
  const WithRotation turning(circle, Vector<3>(0.1, 0.2, 0.3));
  const auto path = [&] {
    if constexpr (std::is_same_v<Space, Pose>) {
      return AnyPath<Space>(turning);
    } else {
      return AnyPath<Space>(circle);
    }
  }();
  PathFollower follower(path, tracker.tip());
  TargetFilter<Space> filter(tracker.tip(), {0.5, 3.0, 100.0, 1.5, 8.0, 300.0});
  const AllocationWatch watch;
  for (int i = 0; i < 2000; ++i) {
    if (i == 100) follower.pause();
    if (i == 200) follower.resume();
    if (i == 300) tracker.stop();
    if (i == 400) tracker.resume();
    (void)tracker.tick(follower);
    if (i % 33 == 0) (void)filter.push(follower.ahead(0.0).x, 1e-3 * i);
    if (i % 500 == 0) (void)filter.push_twist(home.xd);
    (void)tracker.tick(filter);
    auto wild = home;
    wild.xdd.setConstant(i % 100 == 0 ? std::numeric_limits<double>::quiet_NaN() : 0.1 * i);
    wild.xd.setConstant(i < 1000 ? 0.0 : 10.0);
    if (i > 500) (void)tracker.tick(wild);
    if constexpr (Scheme::kLevel == Level::kAcceleration) (void)tracker.resolve_measured(q0, tracker.state().qd, wild);
  }
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_TRUE(tracker.state().q.allFinite() && follower.done());
}

TEST(NoAllocation, in_a_control_loop) {
  const SerialArm<7> fixed(presets::panda());
  const AnyArm<Position<3>> open = any_arm(presets::panda());
  const auto fpbm = FPBM<7>(0.6, Vector<7>(Vector<7>::Ones()), 10.0, 25.0, NullSpace<7>{}.with_damping(2.0));
  expect_none_in_a_loop<Pose>(fixed, ManipulabilityAscent(fpbm, fixed, 0.1));
  expect_none_in_a_loop<Pose>(open, AnyScheme<Level::kAcceleration, Pose>(fpbm));
  expect_none_in_a_loop<Position<3>>(open, AnyScheme<Level::kVelocity, Position<3>>(MVN<kOpen>(5.0)));

  const std::vector<Obstacle<>> obstacles = {
      {"wall", HalfSpace<>{-Vector<3>::UnitX(), -0.75}},
      {"post", Capsule<>{{0.4, 0.3, 0.0}, {0.4, 0.3, 1.0}, 0.03}, Vector<3>(0.0, -0.1, 0.0)},
      {"box", Cuboid<>{{Vector<3>(0.4, -0.4, 0.4), Matrix<3, 3>::Identity()}, Vector<3>::Constant(0.1)}}};
  const Clearance<7> clearance(presets::panda(), presets::capsules::panda(), obstacles, 0.005);
  expect_none_in_a_loop<Pose>(fixed, fpbm, Bounds(clearance));
}

template <typename Scheme>
void expect_none_on_a_kept_path(const Scheme& scheme) {
  const SerialArm<7> arm(presets::panda());
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  Bounds bounds(Clearance<7>(presets::panda(), presets::capsules::panda(), {}, 0.005));
  const WithRotation path(InPlane(Path(Circle(0.1), 0.5, Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}));
  TrackerOptions<> options;
  options.keep_first_level = true;
  const Limits<Scheme::kLevel, 7> limits(arm.limits(), options.dt);
  const Vector<7> rest = Vector<7>::Zero();
  Tracker tracker(arm, Pose{}, scheme, State<7>{q0, rest}, options, limits, rest, bounds);
  const auto kept = kept_path(arm, path, tracker.scheme(), q0, arm.limits(), bounds, FastestOptions{});
  PathFollower follower(kept, tracker.tip(), 0.1);
  const AllocationWatch watch;
  for (int i = 0; i < 5000 && !follower.done(); ++i) {
    if (i == 300) follower.pause();
    if (i == 800) follower.resume();
    if (i == 1000) tracker.stop();
    if (i == 1500) tracker.resume();
    if (i == 1800) tracker.set_speed(0.5);
    (void)tracker.tick(follower);
  }
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_TRUE(follower.done());
}

TEST(NoAllocation, on_a_kept_path) {
  expect_none_on_a_kept_path(MVN<7>(5.0));
  expect_none_on_a_kept_path(FPBM<7>(0.6, UnitWeights{}, 20.0, 100.0));
}

/// In both lanes, the limits are active, so that each tracker completes its ticks separately.
TEST(NoAllocation, in_trackers_side_by_side) {
  using In = Lanes<2>;
  constexpr double kTick = 4e-3;
  const PlanarArm<4> arm(Vector<4>::Ones());
  auto bounds = JointLimits<4>::none(4);
  for (int i = 0; i < 4; ++i) bounds.set(i, {-3.5, 3.9, 0.2, 2.0});
  TrackerOptions<> options;
  options.dt = kTick;
  const AccelerationScheme<4, double, UnitWeights> scheme(0.0, {}, 10.0, 25.0, {}, SingularDamping<>());
  const AccelerationScheme<4, In, UnitWeights> in_lanes(In(0.0), {}, In(10.0), In(25.0), {}, SingularDamping<In>());
  const State<4> start{paper_start().q, Vector<4>::Zero()};
  const Tracker tracker(arm, Position<2>{}, scheme, start, options, {bounds, kTick});
  TrackerBatch all(arm.cast<In>(), Position<2>{}, in_lanes, std::vector{tracker, tracker});
  const Path path(Circle<>(0.45), 1.0);
  int samples = 0;
  const AllocationWatch watch;
  (void)track_batch(all, path, TimeGrid<>(1.0, kTick, 0.2), [&](const auto&) { ++samples; });
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_GT(samples, 250);
  for (const Status status : all.status()) EXPECT_EQ(status, Status::kSlowed);
}

TEST(NoAllocation, in_task_levels) {
  constexpr int N = Eigen::Dynamic;
  const Vector<N> wide = Vector<N>::Constant(7, 0.3);
  Matrix<N, N> J(3, 7);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 7; ++j) J(i, j) = std::sin(1.0 + i * 7 + j);
  }
  const Matrix<N, N> identity = Matrix<N, N>::Identity(7, 7);
  const AllocationWatch watch;
  LevelSaturation<N> levels({-wide, wide}, Vector<N>::Zero(7), wide);
  const double first = levels.resolve<N>(J, Vector<N>::Constant(3, 0.5));
  const Matrix<1, N> again = J.topRows<1>();  // In conflict with the first level.
  const double damped = levels.resolve<1>(again, Vector<1>(-0.5), 0.05);
  const double second = levels.resolve<N>(identity, Vector<N>::Constant(7, 1.0));
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_EQ(levels.lost(), 0.0);
  EXPECT_EQ(damped, 1.0);
  EXPECT_GT(first, 0.0);
  EXPECT_LT(second, 1.0);
}

/// A stack of tasks with active limits and a disabled level.
TEST(NoAllocation, in_a_stack) {
  const Robot<7> robot(presets::panda());
  constexpr int kTip = Robot<7>::kTip;
  const TaskGains<> gains(10.0, 25.0);
  const Stack stack(AxisTask<>{{kTip}, gains}, PositionTask<>{{kTip}, gains}, PostureTask<7>{gains});
  const auto scheme = Balanced<7>(0.6, UnitWeights{}, NullSpace<7>().with_damping(2.0));
  auto tracker = stack_tracker(robot, stack, scheme, Vector<7>(panda_ready()));
  auto [axis, place, posture] = tracker.tip();
  const auto upright = Reference<Direction>::hold(axis);
  const auto far = Reference<Position<3>>::hold(place + Vector<3>(0.5, 0.5, 0.0));
  const auto home = Reference<JointSpace<7>>::hold(posture);
  int slowed = 0;
  const AllocationWatch watch;
  for (int i = 0; i < kSteps; ++i) {
    if (i == kSteps / 2) tracker.enable(2, false);
    slowed += tracker.tick(upright, far, home).status == Status::kSlowed ? 1 : 0;
  }
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_GT(slowed, 0);
}

/// A motion that must stop does not allocate either.
template <typename Inverse, typename Point, typename Joints>
void expect_none_in_inverse(Inverse inverse, const Point& near, const Point& far, const Joints& start) {
  const AllocationWatch watch;
  const auto found = inverse.solve(near, start);
  const auto nearest = inverse.solve(far, start);
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_TRUE(found.solved());
  EXPECT_EQ(nearest.status, Status::kNotFound);
}

TEST(NoAllocation, in_inverse_kinematics) {
  const Chain<> chain = presets::panda();
  const SerialArm<7> arm(chain);
  const Vector<7> start = panda_ready();
  Kinematics<Pose, 7> kinematics;
  arm.kinematics(Vector<7>(start + Vector<7>::Constant(0.4)), kinematics);
  const Transform<> near = kinematics.tip;
  Transform<> far = near;
  far.p(0) = 3.0;
  expect_none_in_inverse(InverseKinematics(arm, Pose{}), near, far, start);
  expect_none_in_inverse(InverseKinematics<SerialArm<7>, Pose, Lanes<2>>(arm, Pose{}), near, far, start);
  expect_none_in_inverse(InverseKinematics(any_arm(chain), Pose{}), near, far, Vector<kOpen>(start));

  const Robot<7> robot(chain);
  const Stack stack(PoseTask<>{LinkFrame<>(Robot<7>::kTip), TaskGains<>(1.0)}, PostureTask<7>{TaskGains<>(1.0)});
  const Clearance<7> clearance(chain, presets::capsules::panda(), {{"table", HalfSpace<>{{0.0, 0.0, 1.0}, 0.0}}}, 0.0,
                               presets::never_collide::panda());
  const InverseKinematics clear(robot, stack, {}, robot.limits(), Bounds(clearance));
  auto both = clear.tip(start);
  std::get<0>(both) = near;
  auto none = both;
  std::get<0>(none) = far;
  expect_none_in_inverse(clear, both, none, start);
}

TEST(NoAllocation, in_a_rollout_that_fails) {
  const AnyPath<Position<2>> path(Path(Line<2>(Vector<2>(3.0, 0.0)), kDuration));
  const Watched watched = watched_rollout(paper_arm(), path, paper_fpbm(), paper_start().q, [] {});
  EXPECT_EQ(watched.count.total(), 0);
  EXPECT_NE(watched.status, Status::kOk);
}

/// Dynamics of a robot whose size is known at run time, with a mimic joint, with payloads from 0 to 3 kg.
TEST(NoAllocation, in_the_dynamics) {
  Chain<> chain = coupled_panda();
  for (auto& joint : chain.joints) joint.moved = {1.0, {0.0, 0.0, 0.1}};
  Dynamics<kOpen> dynamics(chain);
  Dynamics<kOpen>::State state;
  Vector<kOpen> q = Vector<kOpen>::Constant(dynamics.dof(), 0.5);
  double sum = 0.0;
  const AllocationWatch watch;
  for (int i = 0; i < kSteps; ++i) {
    const LinkInertia<> load{0.03 * i, {0.0, 0.0, 0.1}};
    if (!dynamics.set_payload(Robot<kOpen>::kTip, load)) break;
    dynamics.robot().update(q, q, state);
    sum += dynamics.inverse_dynamics(state, q)(0) + dynamics.bias(state)(0) + dynamics.gravity_torque(state)(0);
    sum += dynamics.mass_matrix(state)(0, 0) + dynamics.kinetic_energy(state) + dynamics.potential_energy(state);
    q(0) += 0.01;
  }
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_GT(sum, 0.0);
  EXPECT_NEAR(dynamics.link(dynamics.robot().joints()).mass, 1.0 + 0.03 * (kSteps - 1), 1e-12);
}

/// Plants one allocation at each of the 101 samples, and returns the counts of the watches.
AllocationCount planted(void (*allocate)()) {
  return on_the_papers_circle(paper_fpbm(), allocate).count;
}

/// Volatile, so that the compiler does not remove an allocation together with its release.
void* volatile seen;

TEST(AllocationWatch, detects_every_form_of_new) {
  constexpr auto kWide = std::align_val_t(64);
  EXPECT_EQ(planted([] { seen = ::operator new(8), ::operator delete(seen); }).by_new, kSteps + 1);
  EXPECT_EQ(planted([] { seen = ::operator new[](8), ::operator delete[](seen); }).by_new, kSteps + 1);
  EXPECT_EQ(planted([] { seen = ::operator new(8, std::nothrow), ::operator delete(seen); }).by_new, kSteps + 1);
  EXPECT_EQ(planted([] { seen = ::operator new[](8, std::nothrow), ::operator delete[](seen); }).by_new, kSteps + 1);
  EXPECT_EQ(planted([] { seen = ::operator new(8, kWide), ::operator delete(seen, kWide); }).by_new, kSteps + 1);
  EXPECT_EQ(planted([] { seen = ::operator new[](8, kWide), ::operator delete[](seen, kWide); }).by_new, kSteps + 1);
  EXPECT_EQ(planted([] { seen = ::operator new(8, kWide, std::nothrow), ::operator delete(seen, kWide); }).by_new,
            kSteps + 1);
  EXPECT_EQ(planted([] { seen = ::operator new[](8, kWide, std::nothrow), ::operator delete[](seen, kWide); }).by_new,
            kSteps + 1);
}

TEST(AllocationWatch, counts_malloc_and_its_variants) {
  if (!AllocationWatch::kSeesMalloc) GTEST_SKIP() << "a sanitizer keeps malloc for itself";
  EXPECT_EQ(planted([] { seen = std::malloc(8), std::free(seen); }).by_malloc, kSteps + 1);
  EXPECT_EQ(planted([] { seen = std::calloc(2, 8), std::free(seen); }).by_malloc, kSteps + 1);
  EXPECT_EQ(planted([] { seen = std::realloc(nullptr, 8), std::free(seen); }).by_malloc, kSteps + 1);
  EXPECT_EQ(planted([] { seen = std::aligned_alloc(64, 64), std::free(seen); }).by_malloc, kSteps + 1);
  EXPECT_EQ(planted([] {
              void* memory = nullptr;
              if (posix_memalign(&memory, 64, 64) == 0) seen = memory, std::free(seen);
            }).by_malloc,
            kSteps + 1);
}

TEST(AllocationWatch, counts_allocations_of_eigen) {
  const AllocationCount count = planted([] {
    const Eigen::VectorXd heap = Eigen::VectorXd::Zero(kSteps);
    seen = const_cast<double*>(heap.data());
  });
  EXPECT_EQ(count.by_eigen, kSteps + 1);
}

TEST(AllocationWatch, counts_nothing_outside_its_lifetime) {
  seen = ::operator new(8), ::operator delete(seen);
  const AllocationWatch watch;
  EXPECT_EQ(watch.count().total(), 0);
}

}  // namespace
}  // namespace fpbm::test
