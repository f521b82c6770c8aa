#include "fpbm/sim/summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/arms.hpp"
#include "support/paper.hpp"

/// A summary of a motion equals what its samples give, all of them kept.
namespace fpbm::test {
namespace {

template <typename Space, int N>
using Samples = std::vector<Sample<Space, N>>;

/// Runs a motion into samples and a summary at once.
template <typename Arm, typename Path, typename Scheme, typename Space = typename Path::Space>
std::pair<Samples<Space, Arm::kDof>, MotionSummary<>> both(const Arm& arm, const Path& path, const Scheme& scheme,
                                                           const State<Arm::kDof>& start, const TimeGrid<>& grid) {
  Samples<Space, Arm::kDof> samples;
  Summary<Space, Arm::kDof> summary(Scheme::kLevel);
  const auto result = rollout(arm, path, scheme, start, grid, [&](const auto& sample) {
    samples.push_back(sample);
    summary(sample);
  });
  EXPECT_EQ(samples.size(), static_cast<std::size_t>(result.samples));
  EXPECT_GT(samples.size(), 2U) << message(result.status);
  return {samples, summary.result()};
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

TEST(Summary, equals_what_the_samples_give) {
  on_every_arm([](const auto& each, const auto& q, const auto&) {
    using Space = typename std::decay_t<decltype(each)>::Space;
    using Joints = std::decay_t<decltype(q)>;
    constexpr int N = Joints::RowsAtCompileTime;
    using Positions =
        std::conditional_t<Space::kRows == 2 || std::is_same_v<Space, PlanarPose>, Position<2>, Position<3>>;
    const Path line(Line<Positions::kRows>(Vector<Positions::kRows>::Constant(0.002)), 0.2);
    const auto path = [&line] {
      if constexpr (std::is_same_v<Space, Positions>) {
        return AnyPath<Space>(line);
      } else {
        using Turned = WithRotation<Path<Line<Positions::kRows>>>;
        return AnyPath<Space>(Turned(line, Turned::Rotation::Constant(0.01)));
      }
    }();
    const TimeGrid<> grid(path.duration(), 0.01, 0.1);
    const State<N> start{q, Joints::Zero(q.size())};
    {
      // Gains that the step does not resolve well, so that there is an error.
      const auto scheme = FPBM<N>(0.6, Joints(Joints::Ones(q.size())), 30.0, 80.0);
      const auto [samples, summary] = both(each.arm, path, scheme, start, grid);
      expect_agreement<Space, N>(samples, summary);
      expect_accelerations<Space, N>(samples, summary);
      EXPECT_GT(summary.max_error, 0.0);
      EXPECT_EQ(summary.max_orientation_error > 0.0, !(std::is_same_v<Space, Positions>));
    }
    {
      const auto [samples, summary] = both(each.arm, path, MVN<N>(5.0), start, grid);
      expect_agreement<Space, N>(samples, summary);
      expect_differences<Space, N>(samples, summary);
    }
  });
}

/// At constant speed the largest slopes of qd may be those at the ends.
TEST(Summary, counts_the_slopes_at_the_ends) {
  const AnyPath<Position<2>> path(Path(Circle(0.45), 1.0, ConstantSpeed{}));
  for (const double dt : {0.1, 0.01}) {
    const auto [samples, summary] = both(paper_arm(), path, MVN<4>(), paper_start(), TimeGrid<>(1.0, dt));
    expect_differences<Position<2>, 4>(samples, summary);
  }
}

TEST(Summary, finds_what_is_in_between) {
  const AnyPath<Position<2>> path = paper_circle();
  const auto [samples, summary] = both(paper_arm(), path, paper_fpbm(), paper_start(), TimeGrid<>(kDuration, 1e-2));
  EXPECT_LT(summary.manipulability, manipulability(samples.front().J));
  EXPECT_LT(summary.manipulability, manipulability(samples.back().J));
  EXPECT_GT(summary.peak_velocity, 2.0 * summary.final_velocity);
}

TEST(Summary, of_nothing_is_empty) {
  const MotionSummary<> summary = Summary<Position<2>, 4>(Level::kVelocity).result();
  EXPECT_EQ(summary.max_error, 0.0);
  EXPECT_EQ(summary.peak_velocity, 0.0);
  EXPECT_EQ(summary.peak_acceleration, 0.0);
  EXPECT_EQ(summary.manipulability, std::numeric_limits<double>::infinity());
}

/// A recorder can end the motion, and the samples before are good.
TEST(Rollout, ends_where_the_recorder_says_so) {
  int seen = 0;
  const auto result = rollout(paper_arm(), paper_circle(), paper_fpbm(), paper_start(), TimeGrid<>(kDuration, 1e-2),
                              [&](const auto&) noexcept { return ++seen < 7; });
  EXPECT_EQ(seen, 7);
  EXPECT_EQ(result.samples, 7);
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_DOUBLE_EQ(result.time, 0.06);
}

}  // namespace
}  // namespace fpbm::test
