#include <gtest/gtest.h>

#include "support/paper.hpp"
#include "support/recording.hpp"

/// Self-motion: no scheme of the paper damps the self-motion; the secondary motion z does.
namespace fpbm::test::rest_laws {
namespace {

Recording<4> circle_and_hold(const NullSpace<4>& null_space) {
  return recorded(paper_arm(), paper_circle(), paper_fpbm(null_space), paper_start(),
                  TimeGrid<>(kDuration, 1e-3, 30.0));
}

/// Largest displacement of any joint during the hold [rad].
double travel_during_hold(const Recording<4>& run) {
  return (run.result.last.q - run.samples[10000].q).cwiseAbs().maxCoeff();
}

TEST(Rest, is_never_reached_without_damping) {
  const auto run = circle_and_hold({});
  ASSERT_EQ(run.result.status, Status::kOk);
  EXPECT_GT(run.result.last.qd.norm(), 1e-3);
  EXPECT_NEAR(travel_during_hold(run), 0.66, 0.005);
  EXPECT_LE(run.max_error(), 1e-12) << "the tip is at rest meanwhile";
}

TEST(Rest, is_reached_with_damping) {
  const auto run = circle_and_hold(NullSpace<4>{}.with_damping(2.0));
  ASSERT_EQ(run.result.status, Status::kOk);
  EXPECT_LT(run.result.last.qd.norm(), 1e-6);
  EXPECT_NEAR(travel_during_hold(run), 0.004, 0.0005);
  EXPECT_LE(run.max_error(), 1e-12) << "the task is not disturbed";
}

/// With a rest posture, the arm repeats its motion from circle to circle. Without a rest posture, the arm drifts.
TEST(Rest, posture_makes_circles_repeat) {
  const TimeGrid<> grid(kDuration, 5e-3);
  const auto chain = [&](const NullSpace<4>& null_space, auto&& each) {
    State<4> state = paper_start();
    for (int circle = 1; circle <= 20; ++circle) {
      const auto result = recorded(paper_arm(), paper_circle(), paper_fpbm(null_space), state, grid).result;
      ASSERT_EQ(result.status, Status::kOk) << "circle " << circle;
      state = result.last;
      each(circle, state);
    }
  };
  Vector<4> second = Vector<4>::Zero();
  chain(NullSpace<4>{}.with_damping(2.0).with_rest_posture(paper_start().q, 1.0), [&](int circle, const State<4>& end) {
    if (circle == 2) second = end.q;
    if (circle > 2) {
      EXPECT_LE((end.q - second).cwiseAbs().maxCoeff(), 1e-5) << "circle " << circle;
    }
  });
  double drift = 0.0;
  chain({}, [&](int circle, const State<4>& end) {
    if (circle == 2) second = end.q;
    drift = std::max(drift, (end.q - second).norm());
  });
  EXPECT_GT(drift, 0.1);
}

}  // namespace
}  // namespace fpbm::test::rest_laws
