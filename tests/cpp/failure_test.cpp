#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "fpbm/any/any_scheme.hpp"
#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/random.hpp"
#include "support/recording.hpp"

/// A motion that leaves the workspace ends with a status in time, and its samples are accurate. A motion well inside
/// the workspace is completed.
namespace fpbm::test::failure_laws {
namespace {

/// A line for a random arm in a random posture.
struct Task {
  Eigen::VectorXd lengths;
  Eigen::VectorXd q0;
  Vector<2> displacement;  ///< [m]
  double duration;
  double dt;
  std::uint32_t seed;  ///< For the weights.
};

struct Ending {
  Status status;
  double time;
  int samples;
  double max_error;
  bool finite;
};

constexpr int kOpen = Eigen::Dynamic;

template <typename Scheme>
Ending run(const Task& task, const Scheme& scheme) {
  const AnyPath<Position<2>> path(Path(Line<2>(task.displacement), task.duration));
  const State<kOpen> start{task.q0, Vector<kOpen>::Zero(task.q0.size())};
  const TimeGrid<> grid(task.duration, task.dt);
  const auto motion = recorded(any_planar_arm(task.lengths), path, erased(scheme), start, grid);
  const bool finite = std::all_of(motion.samples.begin(), motion.samples.end(), [](const auto& sample) {
    return sample.q.allFinite() && sample.qd.allFinite() && sample.qdd.allFinite() && sample.error.allFinite();
  });
  return {motion.result.status, motion.result.time, motion.result.samples, motion.max_error(), finite};
}

Vector<kOpen> weights(const Task& task) {
  return Random(task.seed).uniform(task.q0.size(), 0.5, 8.0);
}

/// A scheme on an arm with `dof` joints.
struct Contender {
  std::string name;
  int dof;
  Ending (*run)(const Task&);
};

void PrintTo(const Contender& contender, std::ostream* out) {
  *out << contender.name;
}

std::vector<Contender> contenders() {
  std::vector<Contender> all;
  for (const int dof : {2, 4, 7}) {
    const auto add = [&](const char* scheme, Ending (*go)(const Task&)) {
      all.push_back({std::string(scheme) + "_n" + std::to_string(dof), dof, go});
    };
    add("MVN", [](const Task& task) { return run(task, MVN<kOpen>()); });
    add("WMVN", [](const Task& task) { return run(task, WMVN<kOpen>(weights(task), 5.0)); });
    add("MAN", [](const Task& task) { return run(task, MAN<kOpen>()); });
    add("FPBM", [](const Task& task) { return run(task, FPBM<kOpen>(0.6, weights(task), 1.0, 1.0)); });
    add("FPBM_damped", [](const Task& task) {
      return run(task, FPBM<kOpen>(0.6, weights(task), 1.0, 1.0, NullSpace<kOpen>{}.with_damping(2.0)));
    });
  }
  return all;
}

Vector<2> tip(const Eigen::VectorXd& lengths, const Eigen::VectorXd& q) {
  const PlanarArm<Eigen::Dynamic> arm(lengths);
  Kinematics<Position<2>, Eigen::Dynamic> kinematics;
  arm.kinematics(q, kinematics);
  return kinematics.tip;
}

class Failure : public ::testing::TestWithParam<Contender> {};

TEST_P(Failure, ends_a_line_that_leaves_the_workspace) {
  const int n = GetParam().dof;
  for (const double dt : {1e-3, 1e-2}) {
    for (std::uint32_t seed = 0; seed < 30; ++seed) {
      SCOPED_TRACE("dt = " + std::to_string(dt) + ", seed " + std::to_string(seed));
      Random random(seed);
      const Eigen::VectorXd lengths = random.uniform(n, 0.5, 1.5);
      const Eigen::VectorXd q0 = random.uniform(n, -2.0, 2.0);
      const double direction = random.uniform(-kPi, kPi);
      const double reach = lengths.sum();
      // Longer than the diameter of the workspace: leaves it from any start.
      const Vector<2> displacement = 2.5 * reach * Vector<2>(std::cos(direction), std::sin(direction));
      const Task task{lengths, q0, displacement, 5.0, dt, seed};
      const Ending ending = GetParam().run(task);

      const Path<Line<2>> path(Line<2>(displacement), task.duration);
      double exit = 0.0;
      while ((tip(lengths, q0) + path.sample(exit).x).norm() <= reach) exit += dt;
      const double longest_step = kPi / 2.0 * displacement.norm() / task.duration * dt;

      EXPECT_NE(ending.status, Status::kOk);
      EXPECT_TRUE(ending.finite);
      EXPECT_LE(ending.time, exit + 2.0 * dt);
      EXPECT_LE(ending.max_error, longest_step);
      EXPECT_LE(ending.samples, static_cast<int>(std::lround(ending.time / dt)) + 1);
    }
  }
}

/// From a singular start, no sample is recorded.
TEST_P(Failure, rejects_a_singular_start) {
  const int n = GetParam().dof;
  for (const double direction : {0.0, 0.3}) {
    for (const double fold : {0.0, kPi}) {
      Random random(1);
      Eigen::VectorXd q0 = Eigen::VectorXd::Zero(n);
      q0(0) = direction;
      q0(1) = fold;
      for (const double length : {0.1, -0.1}) {
        const Vector<2> displacement = length * Vector<2>(std::cos(direction), std::sin(direction));
        const Ending ending = GetParam().run({random.uniform(n, 0.5, 1.5), q0, displacement, 1.0, 1e-2, 0});
        EXPECT_EQ(ending.status, Status::kSingular);
        EXPECT_EQ(ending.samples, 0);
        EXPECT_EQ(ending.time, 0.0);
      }
    }
  }
}

/// From a well-bent posture, the tip moves by a fifth of a link in any direction without a false alarm.
TEST_P(Failure, does_not_stop_a_motion_well_inside_the_workspace) {
  const int n = GetParam().dof;
  for (const double dt : {1e-3, 1e-2, 0.1}) {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE("dt = " + std::to_string(dt) + ", seed " + std::to_string(seed));
      Random random(seed);
      const double bend = 2.0 / (n - 1);
      Eigen::VectorXd q0 = random.uniform(n, 0.7 * bend, bend);
      q0(0) = random.uniform(-kPi, kPi);
      const double direction = random.uniform(-kPi, kPi);
      const Task task{
          random.uniform(n, 0.8, 1.2), q0, 0.2 * Vector<2>(std::cos(direction), std::sin(direction)), 5.0, dt, seed};
      const Ending ending = GetParam().run(task);
      EXPECT_EQ(ending.status, Status::kOk);
      EXPECT_EQ(ending.time, task.duration);
      EXPECT_TRUE(ending.finite);
      EXPECT_LE(ending.max_error, 1e-3 * std::pow(dt, 2));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(every, Failure, ::testing::ValuesIn(contenders()),
                         [](const auto& each) { return each.param.name; });

/// Effect of the step length on a motion. Errors are relative to the largest entry of J, its longest lever arm.
struct Accuracy {
  Status status;
  double error = 0.0;  ///< Largest tip error, relative to the lever arm of the sample.
};

template <Level kLevel, typename Space>
[[nodiscard]] Accuracy accuracy(const AnyArmFor<Space>& arm, const AnyPath<Space>& path,
                                const AnyScheme<kLevel, Space>& scheme, const State<kOpen>& start, double dt) {
  Accuracy result{Status::kOk};
  const auto record = [&](const auto& sample) noexcept {
    result.error = std::max(result.error, sample.error.norm() / sample.J.cwiseAbs().maxCoeff());
  };
  result.status = rollout(arm, path, scheme, start, TimeGrid<>(path.duration(), dt), record).status;
  return result;
}

struct AccuracyTally {
  int fine = 0;
  int coarse = 0;
};

/// From rest on the path, the step length is the only cause of a tip error. The status reports a coarse step exactly if
/// the error exceeds 1e-4 lever arms.
template <typename Space>
void expect_the_truth(const AnyArmFor<Space>& arm, const AnyPath<Space>& path, double dt, Random& random,
                      AccuracyTally& tally) {
  using Velocities = AnyScheme<Level::kVelocity, Space>;
  using Accelerations = AnyScheme<Level::kAcceleration, Space>;
  const int n = arm.dof();
  const State<kOpen> q0{random.uniform(n, -2.0, 2.0), Vector<kOpen>::Zero(n)};
  const Vector<kOpen> W = random.uniform(n, 0.5, 5.0);
  const double k = std::pow(10.0, random.uniform(-1.0, 1.5));
  const double alpha = random.uniform(0.0, 1.0);
  const auto z = NullSpace<kOpen>{}.with_damping(std::pow(10.0, random.uniform(-1.0, 2.0)));
  for (const Accuracy& run : {accuracy(arm, path, Velocities(WMVN<kOpen>(W)), q0, dt),
                              accuracy(arm, path, Velocities(WMVN<kOpen>(W, k)), q0, dt),
                              accuracy(arm, path, Accelerations(Balanced<kOpen>(alpha, W)), q0, dt),
                              accuracy(arm, path, Accelerations(Balanced<kOpen>(alpha, W, z)), q0, dt),
                              accuracy(arm, path, Accelerations(FPBM<kOpen>(alpha, W, 2.0 * k, k * k, z)), q0, dt)}) {
    if (failed(run.status)) continue;
    EXPECT_EQ(run.status == Status::kOk, run.error <= 1e-4) << message(run.status) << ", error " << run.error;
    ++(run.error <= 1e-4 ? tally.fine : tally.coarse);
  }
}
TEST(StepLength, is_reported_if_it_causes_the_tip_error) {
  AccuracyTally tally;
  for (int seed = 0; seed < trials(400); ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    const double dt = std::vector<double>{1e-3, 5e-3, 2e-2}[static_cast<std::size_t>(seed % 3)];
    const double duration = 1.0 + seed % 4;
    SCOPED_TRACE("seed " + std::to_string(seed) + ", dt = " + std::to_string(dt));
    if (seed % 2 == 0) {
      const auto arm = any_planar_arm(random.uniform(2 + seed % 6, 0.5, 1.5));
      if (seed % 4 == 0) {
        const AnyPath<Position<2>> circle(Path(Circle(random.uniform(0.1, 1.0)), duration));
        expect_the_truth<Position<2>>(arm, circle, dt, random, tally);
      } else {
        const AnyPath<Position<2>> line(Path(Line<2>(random.uniform(2, -1.0, 1.0)), duration));
        expect_the_truth<Position<2>>(arm, line, dt, random, tally);
      }
    } else {
      const std::vector<Chain<>> chains{presets::panda(), presets::gen3(), panda_on_rail(), coupled_panda()};
      const auto arm = any_arm(chains[static_cast<std::size_t>(seed / 2) % 4]);
      const Path circle(Circle(random.uniform(0.05, 0.3)), duration);
      const InPlane path(circle, Vector<3>::UnitY(), Vector<3>::UnitZ());
      if (seed % 4 == 1) {
        expect_the_truth<Position<3>>(arm, AnyPath<Position<3>>(path), dt, random, tally);
      } else {
        expect_the_truth<Pose>(arm, AnyPath<Pose>(WithRotation(path)), dt, random, tally);
      }
    }
  }
  EXPECT_GT(tally.fine, trials(1000));
  EXPECT_GT(tally.coarse, 0);
  std::printf("%d motions fine, %d of too long a step\n", tally.fine, tally.coarse);
}

/// If the start velocity differs from the velocity of the path, the status does not attribute the error to the step
/// length.
TEST(StepLength, is_not_reported_for_a_start_error) {
  int wrong = 0;
  for (int seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint32_t>(seed));
    const int n = 3 + seed % 5;
    const auto arm = any_planar_arm(random.uniform(n, 0.5, 1.5));
    const AnyPath<Position<2>> path(Path(Circle(random.uniform(0.1, 0.5)), 2.0));
    const State<kOpen> start{random.uniform(n, 0.5, 1.0), random.uniform(n, -0.1, 0.1)};
    const Vector<kOpen> W = random.uniform(n, 0.5, 5.0);
    const double k = std::pow(10.0, random.uniform(-1.0, 1.5));
    for (const double k1 : {0.0, 0.5 * k, 2.0 * k, 5.0 * k}) {
      const Accuracy run = accuracy(arm, path, erased(FPBM<kOpen>(0.6, W, k1, k * k)), start, 1e-3);
      EXPECT_NE(run.status, Status::kCoarse);
      wrong += run.status == Status::kOk && run.error > 1e-4 ? 1 : 0;
    }
  }
  EXPECT_GT(wrong, 300);
}

/// Every status has a message, and every failure has advice.
TEST(Status, has_a_message_and_advice) {
  for (const Status status : {Status::kOk, Status::kCoarse, Status::kDamped, Status::kSlowed, Status::kRecovering,
                              Status::kStalled, Status::kSingular, Status::kTaskLost, Status::kNotFinite}) {
    EXPECT_STRNE(message(status), "");
    EXPECT_STRNE(message(status), "unknown status");
    EXPECT_EQ(std::string(advice(status)).empty(), status == Status::kOk);
  }
}

}  // namespace
}  // namespace fpbm::test::failure_laws
