#include <gtest/gtest.h>

#include "support/paper.hpp"
#include "support/recording.hpp"

/// A hold after a path: the reference may jump at T, and the motion is accurate before and after T.
namespace fpbm::test::hold_laws {
namespace {

constexpr double kHold = 2.0;

template <typename Path, typename Scheme>
void expect_exact_hold(const Path& path, const Scheme& scheme) {
  const TimeGrid<> grid(kDuration, 1e-3, kHold);
  const auto run = recorded(paper_arm(), path, scheme, paper_start(), grid);
  ASSERT_EQ(run.result.status, Status::kOk);
  ASSERT_EQ(run.samples.size(), 12001U);
  EXPECT_DOUBLE_EQ(run.result.time, kDuration + kHold);
  EXPECT_LE(run.max_error(), 1e-12);

  const auto& first_at_rest = run.samples[10000];
  for (std::size_t i = 10000; i < run.samples.size(); ++i) {
    ASSERT_EQ(run.samples[i].reference.x, first_at_rest.reference.x);
    ASSERT_EQ(run.samples[i].reference.xd, Vector<2>::Zero());
    ASSERT_EQ(run.samples[i].reference.xdd, Vector<2>::Zero());
  }
  EXPECT_LE((first_at_rest.reference.x - run.samples.front().reference.x - path.sample(path.duration()).x).norm(),
            1e-15);
}

/// The time law of the paper ends with a step of the acceleration, from about 0.14 m/s² to zero.
TEST(Hold, is_exact_after_a_jump_of_acceleration) {
  ASSERT_GT(paper_circle().sample(kDuration).xdd.norm(), 0.1);
  expect_exact_hold(paper_circle(), paper_fpbm());
  expect_exact_hold(paper_lissajous(), paper_fpbm());
  expect_exact_hold(paper_tricuspid(), paper_fpbm());
}

/// Constant speed ends with a step of the velocity, which only a velocity-level scheme can follow.
TEST(Hold, is_exact_after_a_jump_of_velocity_at_velocity_level) {
  const AnyPath<Position<2>> path(Path(Circle(0.45), kDuration, ConstantSpeed{}));
  ASSERT_GT(path.sample(kDuration).xd.norm(), 0.1);
  expect_exact_hold(path, WMVN<4>(paper_weights()));
  expect_exact_hold(path, WMVN<4>(paper_weights(), 5.0));
}

/// Without a hold, the last sample belongs to the motion.
TEST(Hold, of_no_length_leaves_the_reference_in_motion_at_T) {
  const auto run = recorded(paper_arm(), paper_circle(), paper_fpbm(), paper_start(), TimeGrid<>(kDuration, 1e-3));
  ASSERT_EQ(run.result.status, Status::kOk);
  EXPECT_EQ(run.samples.back().reference.xdd, paper_circle().sample(kDuration).xdd);
}

/// A rollout in float equals the rollout in double up to the round-off error of its 10 000 steps.
TEST(Float, follows_the_papers_circle) {
  const PlanarArm<4, float> arm(Vector<4, float>::Ones());
  const Path<Circle<float>> path(Circle<float>(0.45F), 10.0F);
  const DiagonalWeights<4, float> weights(Vector<4, float>(1, 2, 3, 4));
  const auto scheme = FPBM<4, float>(0.6F, weights, 1.0F, 1.0F);
  const State<4, float> start{paper_start().q.cast<float>(), Vector<4, float>::Zero()};
  for (const float dt : {1e-3F, 1e-2F}) {
    const auto run = recorded(arm, path, scheme, start, TimeGrid<float>(10.0F, dt, 1.0F));
    ASSERT_EQ(run.result.status, Status::kOk) << "at " << run.result.time;
    EXPECT_LE(run.max_error(), 1e-4F) << "dt = " << dt;
    const auto end = run.samples[static_cast<std::size_t>(std::lround(10.0F / dt))];
    const Vector<4> expected(0.215222487, 0.396791734, 0.1144437012, 0.1756873322);
    EXPECT_LE((end.q.cast<double>() - expected).norm(), 1e-3) << "dt = " << dt;
  }
}

}  // namespace
}  // namespace fpbm::test::hold_laws
