#include "fpbm/simulate/summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/paper.hpp"
#include "support/random.hpp"
#include "support/recording.hpp"

/// The summary of a motion equals the values from all its samples.
namespace fpbm::test::summary_laws {
namespace {

template <typename Space, int N>
using Samples = std::vector<Sample<Space, N>>;

template <typename Space, int N>
MotionSummary<> summary_of(const Samples<Space, N>& samples, Level level) {
  Summary<Space, N> summary(level);
  for (const auto& sample : samples) summary(sample);
  return summary.result();
}

/// A motion of the paper's arm.
template <typename Scheme>
std::pair<Samples<Position<2>, 4>, MotionSummary<>> both(const AnyPath<Position<2>>& path, const Scheme& scheme,
                                                         const TimeGrid<>& grid) {
  const auto run = recorded(paper_arm(), path, scheme, paper_start(), grid);
  EXPECT_EQ(run.samples.size(), static_cast<std::size_t>(run.result.samples));
  EXPECT_GT(run.samples.size(), 2U) << message(run.result.status);
  return {run.samples, summary_of<Position<2>, 4>(run.samples, Scheme::kLevel)};
}

template <typename Space, int N>
void expect_agreement(const Samples<Space, N>& samples, const MotionSummary<>& summary) {
  constexpr int kTurns = std::is_same_v<Space, Pose> ? 3 : std::is_same_v<Space, PlanarPose> ? 1 : 0;
  double error = 0.0;
  double orientation_error = 0.0;
  double velocity = 0.0;
  double manipulability = std::numeric_limits<double>::infinity();
  for (const auto& sample : samples) {
    const Eigen::VectorXd e = sample.error;
    error = std::max(error, e.head(Space::kRows - kTurns).norm());
    orientation_error = std::max(orientation_error, e.tail(kTurns).norm());
    velocity = std::max(velocity, sample.qd.template lpNorm<Eigen::Infinity>());
    manipulability = std::min(manipulability, fpbm::manipulability(sample.J));
  }
  EXPECT_DOUBLE_EQ(summary.max_error, error);
  EXPECT_DOUBLE_EQ(summary.max_orientation_error, orientation_error);
  EXPECT_EQ(summary.peak_velocity, velocity);
  EXPECT_EQ(summary.final_velocity, samples.back().qd.template lpNorm<Eigen::Infinity>());
  EXPECT_EQ(summary.manipulability, manipulability);
}

template <typename Space, int N>
void expect_accelerations(const Samples<Space, N>& samples, const MotionSummary<>& summary) {
  double peak = 0.0;
  for (const auto& sample : samples) peak = std::max(peak, sample.qdd.template lpNorm<Eigen::Infinity>());
  EXPECT_EQ(summary.peak_acceleration, peak);
  EXPECT_EQ(summary.final_acceleration, samples.back().qdd.template lpNorm<Eigen::Infinity>());
}

template <typename Space, int N>
void expect_differences(const Samples<Space, N>& samples, const MotionSummary<>& summary) {
  const auto slope = [&](std::size_t i, std::size_t j) {
    return ((samples[j].qd - samples[i].qd) / (samples[j].t - samples[i].t)).template lpNorm<Eigen::Infinity>();
  };
  const std::size_t last = samples.size() - 1;
  double peak = std::max(slope(0, 1), slope(last - 1, last));
  for (std::size_t i = 1; i < last; ++i) peak = std::max(peak, slope(i - 1, i + 1));
  EXPECT_NEAR(summary.peak_acceleration, peak, 1e-9 * peak);
  EXPECT_NEAR(summary.final_acceleration, slope(last - 1, last), 1e-9 * peak);
}

/// For arbitrary samples: the laws of a summary do not depend on an arm or a path.
template <typename Space, int N>
void expect_summaries(Eigen::Index dof) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    Samples<Space, N> samples;
    for (int i = 0; i < 20; ++i) {
      Sample<Space, N> sample{};
      if constexpr (!std::is_same_v<Space, Pose>) sample.tip.setZero();
      sample.reference = Reference<Space>::hold(sample.tip);
      sample.index = i;
      sample.t = 0.01 * i;
      sample.q = random.uniform(dof, -2.0, 2.0);
      sample.qd = random.uniform(dof, -2.0, 2.0);
      sample.qdd = random.uniform(dof, -2.0, 2.0);
      sample.error = random.uniform(Space::kRows, -0.1, 0.1);
      sample.J = random.uniform(Space::kRows, dof, -1.0, 1.0);
      samples.push_back(sample);
    }
    const auto accelerations = summary_of<Space, N>(samples, Level::kAcceleration);
    expect_agreement<Space, N>(samples, accelerations);
    expect_accelerations<Space, N>(samples, accelerations);
    const auto differences = summary_of<Space, N>(samples, Level::kVelocity);
    expect_agreement<Space, N>(samples, differences);
    expect_differences<Space, N>(samples, differences);
  }
}

TEST(Summary, equals_that_of_the_samples) {
  for (const Eigen::Index dof : {6, 7, 9}) expect_summaries<Pose, Eigen::Dynamic>(dof);
  for (const Eigen::Index dof : {3, 6}) expect_summaries<PlanarPose, Eigen::Dynamic>(dof);
  expect_summaries<Position<3>, 7>(7);
}

/// With gains that the step does not resolve well, so that an error occurs.
TEST(Summary, equals_that_of_the_samples_of_a_motion) {
  const AnyPath<Position<2>> path(Path(Line<2>(Vector<2>(0.002, 0.002)), 0.2));
  const TimeGrid<> grid(path.duration(), 0.01, 0.1);
  const auto [samples, summary] = both(path, FPBM<4>(0.6, Vector<4>(Vector<4>::Ones()), 30.0, 80.0), grid);
  expect_agreement<Position<2>, 4>(samples, summary);
  expect_accelerations<Position<2>, 4>(samples, summary);
  EXPECT_GT(summary.max_error, 0.0);
  EXPECT_EQ(summary.max_orientation_error, 0.0);
  const auto [at_velocity_level, differences] = both(path, MVN<4>(5.0), grid);
  expect_agreement<Position<2>, 4>(at_velocity_level, differences);
  expect_differences<Position<2>, 4>(at_velocity_level, differences);
}

/// At constant speed, the largest slopes of qd may be at the ends.
TEST(Summary, counts_the_slopes_at_the_ends) {
  const AnyPath<Position<2>> path(Path(Circle(0.45), 1.0, ConstantSpeed{}));
  for (const double dt : {0.1, 0.01}) {
    const auto [samples, summary] = both(path, MVN<4>(), TimeGrid<>(1.0, dt));
    expect_differences<Position<2>, 4>(samples, summary);
  }
}

TEST(Summary, includes_samples_between_the_ends) {
  const AnyPath<Position<2>> path = paper_circle();
  const auto [samples, summary] = both(path, paper_fpbm(), TimeGrid<>(kDuration, 1e-2));
  EXPECT_LT(summary.manipulability, manipulability(samples.front().J));
  EXPECT_LT(summary.manipulability, manipulability(samples.back().J));
  EXPECT_GT(summary.peak_velocity, 2.0 * summary.final_velocity);
}

TEST(Summary, without_samples_is_empty) {
  const MotionSummary<> summary = Summary<Position<2>, 4>(Level::kVelocity).result();
  EXPECT_EQ(summary.max_error, 0.0);
  EXPECT_EQ(summary.peak_velocity, 0.0);
  EXPECT_EQ(summary.peak_acceleration, 0.0);
  EXPECT_EQ(summary.manipulability, std::numeric_limits<double>::infinity());
}

/// A recorder can end the motion. The samples before the end are valid.
TEST(Rollout, ends_if_the_recorder_returns_false) {
  int seen = 0;
  const auto result = rollout(paper_arm(), paper_circle(), paper_fpbm(), paper_start(), TimeGrid<>(kDuration, 1e-2),
                              [&](const auto&) noexcept { return ++seen < 7; });
  EXPECT_EQ(seen, 7);
  EXPECT_EQ(result.samples, 7);
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_DOUBLE_EQ(result.time, 0.06);
}

}  // namespace
}  // namespace fpbm::test::summary_laws
