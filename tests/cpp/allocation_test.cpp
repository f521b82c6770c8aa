#include "support/allocation_watch.hpp"  // Before anything that includes Eigen.

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <limits>
#include <new>
#include <vector>

#include "support/paper.hpp"

/// A rollout allocates nothing, whatever the scheme and however the number of joints is chosen; and each of the three
/// watches that say so is seen to fail.
namespace fpbm::test {
namespace {

constexpr int kSteps = 100;

struct Watched {
  Status status;
  int samples;
  AllocationCount count;
};

/// A whole rollout under watch, into buffers of the caller's. `extra` is called at every sample.
template <typename Arm, typename Scheme, typename Extra>
Watched watched_rollout(const Arm& arm, const Scheme& scheme, Extra&& extra) {
  constexpr int N = Arm::kDof;
  static std::array<double, 4 * (kSteps + 1)> q;
  static std::array<double, 2 * (kSteps + 1)> error;
  MotionBuffers<Position<2>, N> buffers;
  buffers.q = q.data();
  buffers.error = error.data();
  const auto path = paper_circle();
  const State<N> start{paper_start().q, Vector<4>::Zero()};
  const TimeGrid<> grid(kDuration, 2.0 * kDuration / kSteps, kDuration);

  const AllocationWatch watch;
  const auto result = rollout(arm, path, scheme, start, grid, [&](const auto& sample) {
    buffers(sample);
    extra();
  });
  return {result.status, result.samples, watch.count()};
}

template <int N>
class NoAllocation {
 public:
  using Dense = DenseWeights<N>;

  static void in_any_scheme() {
    const DiagonalWeights<N> W{Vector<N>(Vector<4>(1, 2, 3, 4))};
    const Dense dense{Matrix<N, N>(Matrix<4, 4>::Identity() + Matrix<4, 4>::Constant(0.2))};
    const auto z = NullSpace<N>{}.with_damping(1.0).with_rest_posture(Vector<4>::Zero(), 1.0);
    in(MVN<N>(), "MVN");
    in(MVN<N>(1.0, z), "MVN with z");
    in(WMVN<N>(W), "WMVN");
    in(WMVN<N, double, Dense>(dense, 1.0, z), "WMVN, dense, with z");
    in(MAN<N>(z), "MAN with z");
    in(WMVNAcceleration<N>(W), "WMVNAcceleration");
    in(WMVNAcceleration<N, double, Dense>(dense, z), "WMVNAcceleration, dense, with z");
    in(Balanced<N>(0.5, W), "Balanced");
    in(Balanced<N, double, Dense>(0.5, dense, z), "Balanced, dense, with z");
    in(FPBM<N>(0.6, W, 1.0, 1.0), "FPBM");
    in(FPBM<N>(0.6, W, 1.0, 1.0, z), "FPBM with z");
    in(FPBM<N, double, Dense>(0.6, dense, 1.0, 1.0, z), "FPBM, dense, with z");
  }

  /// Secondary objectives round a scheme, one in the other.
  static void in_any_wrapper() {
    const PlanarArm<N> arm{Vector<N>(Vector<4>::Ones())};
    const PlanarArm<2> elbow(Vector<2>::Ones());
    const auto point = Reference<Position<2>>::hold(Vector<2>(1.83, 0.76));
    const NullSpace<N> damped = NullSpace<N>{}.with_damping(2.0);
    const FPBM<N> scheme(0.6, DiagonalWeights<N>(Vector<N>(Vector<4>::Ones())), 1.0, 1.0, damped);
    in(ManipulabilityAscent(scheme, arm, 0.1), "ManipulabilityAscent");
    in(SecondTask(scheme, elbow, point, 1.0, 0.1, 0.5), "SecondTask");
    in(SecondTask(ManipulabilityAscent(MVN<N>(1.0), arm, 0.1), elbow, point, 0.0, 0.1, 0.5), "both, at velocity level");
    in(ManipulabilityAscent(SecondTask(MVN<N>(1.0), elbow, point, 0.0, 0.1, 0.5), arm, 0.1),
       "both, the other way round");
  }

 private:
  template <typename Scheme>
  static void in(const Scheme& scheme, const char* name) {
    const PlanarArm<N> arm{Vector<N>(Vector<4>::Ones())};
    const Watched watched = watched_rollout(arm, scheme, [] {});
    EXPECT_EQ(watched.status, Status::kOk) << name;
    EXPECT_EQ(watched.samples, kSteps + 1) << name;
    EXPECT_EQ(watched.count.by_new, 0) << name;
    EXPECT_EQ(watched.count.by_malloc, 0) << name;
    EXPECT_EQ(watched.count.by_eigen, 0) << name;
  }
};

TEST(NoAllocation, in_a_rollout_of_a_fixed_size) {
  NoAllocation<4>::in_any_scheme();
  NoAllocation<4>::in_any_wrapper();
}
TEST(NoAllocation, in_a_rollout_of_a_size_chosen_at_run_time) {
  NoAllocation<Eigen::Dynamic>::in_any_scheme();
  NoAllocation<Eigen::Dynamic>::in_any_wrapper();
}

/// Arms in space, poses, and every kind of path: waypoints take their memory when they are made.
template <typename Arm>
void expect_none_in_space(const Arm& arm) {
  constexpr int N = Arm::kDof;
  Vector<N> q0 = Vector<N>::Zero(arm.dof());
  q0.template tail<7>() << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  const FPBM<N> scheme(0.6, DiagonalWeights<N>(Vector<N>::Ones(arm.dof())), 10.0, 25.0);
  const InPlane circle(Path(Circle(0.05), 5.0), Vector<3>::UnitY(), Vector<3>::UnitZ());
  const std::vector<Transform<>> points{{}, {{0.05, 0.0, 0.05}, rotation(Vector<3>(0.1, 0.2, 0.0))}, {{0.1, 0.0, 0.0}}};
  const Sequence path(WithRotation(circle, Vector<3>(0.1, 0.2, 0.3)), Waypoints<Pose>::lasting(points, 5.0));

  static std::array<double, Pose::kSize*(kSteps + 1)> x;
  MotionBuffers<Pose, N> buffers;
  buffers.x = x.data();
  const State<N> start{q0, 0.0 * q0};
  const TimeGrid<> grid(path.duration(), path.duration() / kSteps);
  const AllocationWatch watch;
  const auto result = rollout(arm, path, scheme, start, grid, buffers);
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_EQ(result.status, Status::kOk);
}

TEST(NoAllocation, in_space) {
  Chain<> chain = presets::panda();
  expect_none_in_space(SerialArm<7>(chain));
  chain.joints.insert(chain.joints.begin(), Joint<>{JointType::kPrismatic});
  chain.joints[0].mimic = {1, 0.1, 0.0};
  expect_none_in_space(CoupledArm<Eigen::Dynamic>(chain));
}

template <typename Arm>
void expect_none_in_a_gaze(const Arm& arm) {
  constexpr int N = Arm::kDof;
  Vector<N> q0 = Vector<N>::Zero(arm.dof());
  q0 << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  const Gaze gaze(arm, Vector<3>(0.1, 0.1, -1.0));
  const auto ahead = Reference<Position<2>>::hold(Vector<2>::Zero());
  const SecondTask scheme(MVN<N>(1.0), gaze, ahead, 0.0, 1.0);
  const InPlane path(Path(Circle(0.05), 5.0), Vector<3>::UnitY(), Vector<3>::UnitZ());
  const State<N> start{q0, 0.0 * q0};
  const TimeGrid<> grid(5.0, 5.0 / kSteps);
  const AllocationWatch watch;
  const auto result = rollout(arm, path, scheme, start, grid, [](const auto&) {});
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_EQ(result.status, Status::kOk);
}

TEST(NoAllocation, in_a_gaze) {
  expect_none_in_a_gaze(SerialArm<7>(presets::panda()));
  expect_none_in_a_gaze(SerialArm<Eigen::Dynamic>(presets::panda()));
}

/// Every call of a control loop, with targets within reach and beyond every limit, and nonsense.
template <typename Space, typename Arm, typename Scheme>
void expect_none_in_a_loop(const Arm& arm, const Scheme& scheme) {
  constexpr int N = Arm::kDof;
  Vector<N> q0 = Vector<N>::Zero(arm.dof());
  q0 << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  TrackerOptions<> options;
  options.integral_gain = 1.0;
  Tracker tracker(arm, Space{}, scheme, q0, options);
  const auto home = Reference<Space>::hold(tracker.tip());
  const InPlane circle(Path(Circle(0.05), 0.5), Vector<3>::UnitY(), Vector<3>::UnitZ());
  const WithRotation turning(circle, Vector<3>(0.1, 0.2, 0.3));
  const auto path = [&] {
    if constexpr (std::is_same_v<Space, Pose>) {
      return turning;
    } else {
      return circle;
    }
  }();
  PathFollower course(path, tracker.tip());
  const AllocationWatch watch;
  for (int i = 0; i < 2000; ++i) {
    if (i == 100) course.pause();
    if (i == 200) course.resume();
    if (i == 300) tracker.stop();
    if (i == 400) tracker.resume();
    (void)tracker.tick(course);
    auto wild = home;
    wild.xdd.setConstant(i % 100 == 0 ? std::numeric_limits<double>::quiet_NaN() : 0.1 * i);
    wild.xd.setConstant(i < 1000 ? 0.0 : 10.0);
    if (i > 500) (void)tracker.tick(wild);
    if constexpr (Scheme::kLevel == Level::kAcceleration) (void)tracker.resolve_measured(q0, tracker.state().qd, wild);
  }
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_TRUE(tracker.state().q.allFinite() && course.done());
}

TEST(NoAllocation, in_a_control_loop) {
  const SerialArm<7> fixed(presets::panda());
  const SerialArm<Eigen::Dynamic> open(presets::panda());
  const Vector<7> ones = Vector<7>::Ones();
  const FPBM<7> fpbm(0.6, DiagonalWeights<7>(ones), 10.0, 25.0, NullSpace<7>{}.with_damping(2.0));
  const FPBM<Eigen::Dynamic> fpbm_open(0.6, DiagonalWeights<Eigen::Dynamic>(ones), 10.0, 25.0);
  expect_none_in_a_loop<Pose>(fixed, fpbm);
  expect_none_in_a_loop<Position<3>>(fixed, fpbm);
  expect_none_in_a_loop<Pose>(open, fpbm_open);
  expect_none_in_a_loop<Position<3>>(open, fpbm_open);
  expect_none_in_a_loop<Pose>(fixed, MVN<7>(5.0));
  expect_none_in_a_loop<Position<3>>(open, MVN<Eigen::Dynamic>(5.0));
  expect_none_in_a_loop<Pose>(fixed, ManipulabilityAscent(fpbm, fixed, 0.1));
}

/// A motion that has to stop does so without an allocation as well.
TEST(NoAllocation, in_a_rollout_that_fails) {
  const Path<Line<2>> path(Line<2>(Vector<2>(3.0, 0.0)), kDuration);
  const PlanarArm<4> arm = paper_arm();
  const FPBM<4> scheme = paper_fpbm();
  const State<4> start = paper_start();
  const TimeGrid<> grid(kDuration, 1e-2);
  const AllocationWatch watch;
  const auto result = rollout(arm, path, scheme, start, grid, [](const auto&) {});
  EXPECT_EQ(watch.count().total(), 0);
  EXPECT_NE(result.status, Status::kOk);
}

/// Plants one allocation at every sample, and tells what the watches saw of the 101.
template <typename Allocate>
AllocationCount planted(Allocate&& allocate) {
  return watched_rollout(paper_arm(), paper_fpbm(), allocate).count;
}

/// Seen through a volatile pointer, lest the compiler take an allocation away with its release.
void* volatile seen;

TEST(AllocationWatch, sees_every_form_of_new) {
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

TEST(AllocationWatch, sees_malloc_and_its_family) {
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

TEST(AllocationWatch, sees_what_eigen_allocates) {
  const AllocationCount count = planted([] {
    const Eigen::VectorXd heap = Eigen::VectorXd::Zero(kSteps);
    seen = const_cast<double*>(heap.data());
  });
  EXPECT_EQ(count.by_eigen, kSteps + 1);
}

TEST(AllocationWatch, sees_nothing_before_and_after_its_life) {
  seen = ::operator new(8), ::operator delete(seen);
  const AllocationWatch watch;
  EXPECT_EQ(watch.count().total(), 0);
}

}  // namespace
}  // namespace fpbm::test
