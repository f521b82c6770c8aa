#include "fpbm/realtime/track.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "support/compiled_tracker.hpp"
#include "support/paper.hpp"
#include "support/recording.hpp"

/// A whole motion of a tracker equals its ticks, one after another.
namespace fpbm::test::track_laws {
namespace {

constexpr double kTick = 1e-3;

[[nodiscard]] AccelerationScheme<4> damped_fpbm() {
  return FPBM<4>(0.6, paper_weights(), 10.0, 25.0, NullSpace<4>{}.with_damping(2.0));
}

[[nodiscard]] auto make_tracker(double velocity) {
  auto bounds = JointLimits<4>::none(4);
  for (int i = 0; i < 4; ++i) bounds.set(i, {-3.0, 3.0, velocity, 100.0});
  const Limits<Level::kAcceleration, 4> limits(bounds, kTick);
  return CompiledTracker(paper_arm(), Position<2>{}, damped_fpbm(), paper_start(), TrackerOptions<>{}, limits);
}

[[nodiscard]] AnyPath<Position<2>> circle() {
  return AnyPath<Position<2>>(Path(Circle<>(0.45), 2.0));
}

using Samples = std::vector<Sample<Position<2>, 4>>;

TEST(Track, is_tick_after_tick) {
  for (const double velocity : {0.3, 3.0}) {
    auto whole = make_tracker(velocity);
    auto single = make_tracker(velocity);
    PathFollower whole_follower(circle(), whole.tip());
    PathFollower single_follower(circle(), single.tip());
    const TimeGrid<> grid(2.0, kTick, 0.5);
    Status worst = Status::kOk;
    int next = 0;
    bool same = true;
    const auto result = track(whole, whole_follower, grid, [&](const auto& sample, const auto& tick) noexcept {
      const State<4> before = single.state();
      const auto reference = single_follower.ahead(0.0);
      const auto expected = single.tick(single_follower);
      worst = worse(worst, expected.status);
      same = same && sample.index == next++ && sample.q == before.q && sample.qd == before.qd &&
             sample.qdd == expected.qdd && sample.error == expected.error && sample.reference.x == reference.x &&
             sample.reference.xd == reference.xd && sample.reference.xdd == reference.xdd && tick.q == expected.q &&
             tick.scale == expected.scale && tick.saturated == expected.saturated && tick.status == expected.status &&
             (sample.reference.x - sample.tip - sample.error).norm() <= 1e-15;
    });
    EXPECT_TRUE(same);
    EXPECT_EQ(next, 2501);
    EXPECT_EQ(result.samples, 2501);
    EXPECT_DOUBLE_EQ(result.time, 2.5);
    EXPECT_EQ(result.status, worst);
    EXPECT_EQ(worst, velocity < 1.0 ? Status::kSlowed : Status::kOk);
    EXPECT_EQ(whole.state().q, single.state().q);
  }
}

/// Far from every limit, the motion equals the rollout up to the error of a tick, which is not a step of RK4. Within
/// narrow limits, the limits hold.
TEST(Track, keeps_the_limits_and_is_a_rollout_far_from_them) {
  const auto record = [](double velocity) {
    auto tracker = make_tracker(velocity);
    PathFollower follower(circle(), tracker.tip());
    Samples samples;
    samples.reserve(2501);
    (void)track(tracker, follower, TimeGrid<>(2.0, kTick, 0.5),
                [&](const auto& sample, const auto&) noexcept { samples.push_back(sample); });
    return samples;
  };
  const Samples expected =
      recorded(paper_arm(), circle(), damped_fpbm(), paper_start(), TimeGrid<>(2.0, kTick, 0.5)).samples;
  const Samples wide = record(3.0);
  ASSERT_EQ(wide.size(), expected.size());
  for (std::size_t i = 0; i < wide.size(); ++i) {
    ASSERT_EQ(wide[i].t, expected[i].t);
    ASSERT_LE((wide[i].q - expected[i].q).norm() + (wide[i].qd - expected[i].qd).norm(), 4e-4) << i;
    ASSERT_LE((wide[i].error - expected[i].error).norm(), 1e-6) << i;
  }
  double fastest = 0.0;
  for (const auto& sample : record(0.3)) fastest = std::max(fastest, sample.qd.cwiseAbs().maxCoeff());
  EXPECT_LE(fastest, 0.3 + 1e-9);
  EXPECT_GT(fastest, 0.299);
}

TEST(Track, ends_if_the_recorder_returns_false) {
  auto tracker = make_tracker(3.0);
  PathFollower follower(circle(), tracker.tip());
  int seen = 0;
  const auto result =
      track(tracker, follower, TimeGrid<>(2.0, kTick), [&](const auto&, const auto&) noexcept { return ++seen < 7; });
  EXPECT_EQ(seen, 7);
  EXPECT_EQ(result.samples, 7);
  EXPECT_DOUBLE_EQ(result.time, 0.006);
}

}  // namespace
}  // namespace fpbm::test::track_laws
