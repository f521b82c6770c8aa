#include "fpbm/limits/detail/saturation.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "support/arms.hpp"
#include "support/linear_program.hpp"

/// Saturation in the null space reaches the task scale of a linear program, along the line of the task and within the
/// box.
namespace fpbm::test::saturation_laws {
namespace {

constexpr int kRows = 6;

/// A box, a start motion `rest` inside the box, and a desired motion.
struct Problem {
  Eigen::MatrixXd J;
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  Eigen::VectorXd rest;
  Eigen::VectorXd desired;
  Eigen::VectorXd unit;
  Eigen::MatrixXd G = {};
  Eigen::VectorXd most = {};
};

template <int M, int N, typename Scalar>
[[nodiscard]] SaturatedMotion<Eigen::Dynamic> saturate_as(const Problem& problem) {
  const auto cast = [](const Eigen::VectorXd& v) { return Vector<N, Scalar>(v.cast<Scalar>()); };
  const Box<N, Scalar> box{cast(problem.lower), cast(problem.upper)};
  const Matrix<M, N, Scalar> J = problem.J.cast<Scalar>();
  const auto in_double = [](const SaturatedMotion<N, Scalar>& found) -> SaturatedMotion<Eigen::Dynamic> {
    return {found.u.template cast<double>(), static_cast<double>(found.scale), found.joints, found.passes, found.rows};
  };
  const Eigen::Index count = problem.most.size();
  if (count == 0) {
    NullSpaceSaturation<M, N, Scalar> saturation(J, cast(problem.unit));
    return in_double(saturation(box, cast(problem.rest), cast(problem.desired)));
  }
  Rows<N, kRows, Scalar> rows;
  rows.g.resize(problem.J.cols(), kRows);
  rows.g.leftCols(count) = problem.G.transpose().cast<Scalar>();
  rows.b.head(count) = problem.most.cast<Scalar>();
  rows.count = count;
  NullSpaceSaturation<M, N, Scalar, kRows> saturation(J, cast(problem.unit), rows);
  return in_double(saturation(box, cast(problem.rest), cast(problem.desired)));
}

[[nodiscard]] SaturatedMotion<Eigen::Dynamic> saturate(const Problem& problem) {
  constexpr int N = Eigen::Dynamic;
  switch (problem.J.rows()) {
    case 1: return saturate_as<1, N, double>(problem);
    case 2: return saturate_as<2, N, double>(problem);
    case 3: return problem.J.cols() == 7 ? saturate_as<3, 7, double>(problem) : saturate_as<3, N, double>(problem);
    case 4: return saturate_as<4, N, double>(problem);
    case 5: return saturate_as<5, N, double>(problem);
    default: return problem.J.cols() == 6 ? saturate_as<6, 6, double>(problem) : saturate_as<6, N, double>(problem);
  }
}

/// Bounds of random widths around 0, a fifth of them active at `rest`, and a desired motion that is mostly too large.
void fill(Random& random, Problem& problem) {
  const Eigen::Index n = problem.J.cols();
  problem.lower = random.uniform(n, -3.0, -0.5);
  problem.upper = random.uniform(n, 0.5, 3.0);
  problem.rest = random.uniform(n, -0.4, 0.4);
  problem.desired = std::pow(10.0, random.uniform(0.0, 1.5)) * random.uniform(n, -1.0, 1.0);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double draw = random.uniform(0.0, 1.0);
    if (draw < 0.1) problem.rest(i) = problem.lower(i);
    if (draw > 0.9) problem.rest(i) = problem.upper(i);
  }
  problem.unit = (problem.upper - problem.lower).cwiseMax(1e-3);
}

struct Tally {
  const char* name;
  int all = 0;
  int slowed = 0;
  int apart = 0;  ///< Number of scales that differ by more than 1e-6.
  int passes = 0;
  double least = 1.0;  ///< Smallest s, relative to the scale of the linear program.
  double off = 0.0;    ///< Largest deviation from the line of the task [rad].
  double beyond_rows = 0.0;

  void check(const Problem& problem) {
    const auto found = saturate(problem);
    ASSERT_TRUE((problem.lower.array() <= found.u.array()).all() && (found.u.array() <= problem.upper.array()).all());
    if (problem.most.size() > 0) {
      const Eigen::VectorXd beyond = problem.G * found.u - problem.most;
      beyond_rows = std::max(beyond_rows, beyond.maxCoeff());
      ASSERT_LE(beyond.maxCoeff(), 1e-12 * (1.0 + problem.G.cwiseAbs().maxCoeff()) * found.u.norm());
    }
    ASSERT_TRUE(found.scale >= 0.0 && found.scale <= 1.0);
    const double most =
        largest_scale(problem.J, problem.lower, problem.upper, problem.rest, problem.desired, problem.G, problem.most);
    const Eigen::VectorXd task = problem.J * (problem.desired - problem.rest);
    const Eigen::VectorXd done = problem.J * (found.u - problem.rest);
    // If the task scale is small, the round-off error of the sums in J u adds to the angle.
    const double round_off = 1e-14 * problem.J.norm() * (problem.upper - problem.lower).norm();
    const double away = (done - found.scale * task).norm();
    off = std::max(off, (away - round_off) / std::max(found.scale * task.norm(), 1e-300));
    ASSERT_LE(away, 1e-9 * found.scale * task.norm() + round_off);
    ASSERT_LE(found.scale, most * (1.0 + 1e-9) + 1e-12);
    ++all;
    if (found.scale < 1.0) ++slowed;
    passes = std::max(passes, found.passes);
    if (found.scale < most - 1e-6 * std::max(most, 1e-3)) ++apart;
    least = std::min(least, (found.scale + 1e-9) / (most + 1e-9));
  }

  ~Tally() {
    std::printf(
        "%s: %d problems, %d slowed, %d miss the optimum by more than 1e-6, the worst has %.6f of it; "
        "off the line by %.1e at most; %d passes at most\n",
        name, all, slowed, apart, least, std::max(off, 0.0), passes);
    EXPECT_LE(apart, all / 1000);
    EXPECT_GE(least, 0.99);
  }
};

template <typename Space, typename Arm>
void check_arm(const char* name, const Arm& arm, int count) {
  constexpr int N = Arm::kDof;
  Random random(5);
  Tally tally{name};
  for (int k = 0; k < trials(count); ++k) {
    Kinematics<Space, N> kinematics;
    arm.kinematics(Vector<N>(random.uniform(arm.dof(), -2.8, 2.8)), kinematics);
    Problem problem{kinematics.J, {}, {}, {}, {}, {}};
    fill(random, problem);
    SCOPED_TRACE(name + std::string(", problem ") + std::to_string(k));
    ASSERT_NO_FATAL_FAILURE(tally.check(problem));
  }
}

TEST(Saturation, is_optimal_on_arms) {
  for (const presets::Preset& preset : presets::kAll) {
    const auto arm = any_arm(preset.chain());
    if (arm.dof() >= Pose::kRows) check_arm<Pose>((std::string(preset.name) + " pose").c_str(), arm, 8000);
    check_arm<Position<3>>((std::string(preset.name) + " position").c_str(), arm, 8000);
  }
  check_arm<Pose>("rail pose", any_arm(panda_on_rail()), 4000);
  for (int n = 2; n <= 7; ++n) {
    const auto arm = any_planar_arm(Vector<Eigen::Dynamic>::Ones(n));
    check_arm<Position<2>>(("planar " + std::to_string(n)).c_str(), arm, 4000);
    if (n > 2) check_arm<PlanarPose>(("planar pose " + std::to_string(n)).c_str(), arm, 4000);
  }
}

/// From the acceleration of the last tick, in the boxes of Limits, of all widths down to zero.
template <typename Space, typename Arm>
void check_jerk(const char* name, const Arm& arm, int count) {
  constexpr int N = Eigen::Dynamic;
  Random random(7);
  Tally tally{name};
  JointLimits<N> bounds = arm.limits();
  bounds.jerk = 200.0 * bounds.acceleration;
  const Limits<Level::kAcceleration, N> limits(bounds, 1e-3);
  const Vector<N> upper = bounds.upper.cwiseMin(3.0);
  const Vector<N> lower = bounds.lower.cwiseMax(-3.0);
  const Vector<N> middle = (upper + lower) / 2.0;
  const Vector<N> reach = (upper - lower) / 2.0;
  for (int k = 0; k < trials(count);) {
    const auto within = [&](const Vector<N>& most) {
      return Vector<N>(most.cwiseProduct(random.uniform(arm.dof(), -1.0, 1.0)));
    };
    const State<N> state{middle + within(reach), within(0.5 * bounds.velocity)};
    const Vector<N> last = within(bounds.acceleration);
    if (!complaint([&] { limits.require_viable(state, last); }).empty()) continue;
    ++k;
    Kinematics<Space, N> kinematics;
    arm.kinematics(state.q, kinematics);
    const Box<N> box = limits.box(state, last);
    const Problem problem{
        kinematics.J, box.lower, box.upper, box.nearest(last), within(3.0 * bounds.acceleration), bounds.acceleration};
    SCOPED_TRACE(name + std::string(", problem ") + std::to_string(k));
    ASSERT_NO_FATAL_FAILURE(tally.check(problem));
  }
}

TEST(Saturation, is_optimal_with_bounds_on_jerk) {
  for (const presets::Preset& preset : presets::kAll) {
    const auto arm = any_arm(preset.chain());
    if (arm.dof() >= Pose::kRows) check_jerk<Pose>((std::string(preset.name) + " pose").c_str(), arm, 2000);
    check_jerk<Position<3>>((std::string(preset.name) + " position").c_str(), arm, 2000);
  }
}

/// Random rows. `rest` is on a third of the rows; some rows are repeated, and some bound a single joint.
template <typename Space, typename Arm>
void check_rows(const char* name, const Arm& arm, int count) {
  Random random(11);
  Tally tally{name};
  for (int k = 0; k < trials(count); ++k) {
    Kinematics<Space, Arm::kDof> kinematics;
    arm.kinematics(Vector<Arm::kDof>(random.uniform(arm.dof(), -2.8, 2.8)), kinematics);
    Problem problem{kinematics.J, {}, {}, {}, {}, {}};
    fill(random, problem);
    const auto rows = static_cast<Eigen::Index>(random.uniform(1.0, kRows + 0.999));
    problem.G = random.uniform(rows, arm.dof(), -1.0, 1.0);
    if (rows > 1 && k % 3 == 0) problem.G.row(0) = problem.G.row(1);
    if (k % 5 == 0) problem.G.row(0) = Eigen::VectorXd::Unit(arm.dof(), k % arm.dof()).transpose();
    if (k % 7 == 0) problem.G.row(0) = problem.J.row(0);
    problem.most = problem.G * problem.rest + random.uniform(rows, -0.5, 1.0).cwiseMax(0.0);
    SCOPED_TRACE(name + std::string(", problem ") + std::to_string(k));
    ASSERT_NO_FATAL_FAILURE(tally.check(problem));
  }
  std::printf("%s: beyond a row by %.1e at most\n", name, tally.beyond_rows);
}

TEST(Saturation, is_optimal_with_rows_beside_the_box) {
  for (const presets::Preset& preset : presets::kAll) {
    const auto arm = any_arm(preset.chain());
    if (arm.dof() >= Pose::kRows) check_rows<Pose>((std::string(preset.name) + " pose").c_str(), arm, 4000);
    check_rows<Position<3>>((std::string(preset.name) + " position").c_str(), arm, 4000);
  }
  check_rows<Position<2>>("planar 4", any_planar_arm(Vector<Eigen::Dynamic>::Ones(4)), 4000);
}

TEST(Saturation, is_optimal_at_every_rank) {
  for (const char* kind : {"full rank", "zero column", "column of round-off", "small column", "repeated columns",
                           "opposite columns", "deficient rank", "zero"}) {
    Random random(11);
    Tally tally{kind};
    for (int k = 0; k < trials(8000); ++k) {
      const Eigen::Index m = 1 + k % 6;
      const Eigen::Index n = m + (k / 6) % 5;
      Problem problem{random.uniform(m, n, -3.0, 3.0), {}, {}, {}, {}, {}};
      Eigen::MatrixXd& J = problem.J;
      const Eigen::Index j = k % n;
      const std::string name = kind;
      if (name == "zero column") J.col(j).setZero();
      if (name == "column of round-off") J.col(j) *= 1e-17;
      if (name == "small column") J.col(j) *= 1e-4;
      if (name == "repeated columns") J.col(j) = J.col((j + 1) % n).eval();
      if (name == "opposite columns") J.col(j) = -2.0 * J.col((j + 1) % n).eval();
      if (name == "deficient rank") J = (random.uniform(m, m - 1, -3.0, 3.0) * J.topRows(m - 1)).eval();
      if (name == "zero") J.setZero();
      fill(random, problem);
      SCOPED_TRACE(name + ", problem " + std::to_string(k));
      ASSERT_NO_FATAL_FAILURE(tally.check(problem));
    }
  }
}

/// Random problems as in the tests of SNS-IK (RethinkRobotics-opensource/sns_ik), each with a task scale that
/// is known to be feasible: J q̈ + J̇ q̇ = s ẍ at acceleration level, J q̇ = s ẋ at velocity level.
struct SnsBounds {
  double J;
  double least;
  double most;
  double drift;
};

void check_sns(const SnsBounds& like) {
  Random random(75);
  int checked = 0;
  for (int k = 0; k < trials(10000); ++k) {
    const auto m = static_cast<Eigen::Index>(random.uniform(1.0, 6.999));
    const auto n = static_cast<Eigen::Index>(random.uniform(static_cast<double>(m), static_cast<double>(m) + 4.999));
    Problem problem{random.uniform(m, n, -like.J, like.J),
                    random.uniform(n, -like.most, -like.least),
                    random.uniform(n, like.least, like.most),
                    Eigen::VectorXd::Zero(n),
                    {},
                    {}};
    problem.unit = problem.upper - problem.lower;
    Eigen::VectorXd u(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double draw = random.uniform(0.0, 1.0);
      u(i) = draw < 0.1   ? problem.lower(i)
             : draw > 0.9 ? problem.upper(i)
                          : random.uniform(problem.lower(i), problem.upper(i));
    }
    const Eigen::VectorXd drift = random.uniform(m, -like.drift, like.drift);
    const double known = std::min(1.0, random.uniform(0.2, 1.2));
    const Eigen::VectorXd task = (problem.J * u + drift) / known;
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> J(problem.J);
    if (like.drift > 0.0) {  // A start motion that cancels the drift, if the box contains one.
      problem.desired = J.solve(-drift);
      const auto rest = saturate(problem);
      if (rest.scale < 1.0) continue;
      problem.rest = rest.u;
    }
    problem.desired = J.solve(task - drift);
    const auto found = saturate(problem);
    SCOPED_TRACE("problem " + std::to_string(k));
    ++checked;
    ASSERT_LE((problem.J * found.u + drift - found.scale * task).cwiseAbs().maxCoeff(), 1e-10);
    ASSERT_GE(found.scale, known - 1e-9);
    ASSERT_TRUE((problem.lower.array() <= found.u.array()).all() && (found.u.array() <= problem.upper.array()).all());
  }
  EXPECT_GE(checked, trials(10000) * 8 / 10);
}

TEST(Saturation, solves_the_random_problems_of_sns_ik_in_acceleration) {
  check_sns({3.0, 1.0, 3.0, 1.0});
}
TEST(Saturation, solves_the_random_problems_of_sns_ik_in_velocity) {
  check_sns({2.0, 0.5, 5.0, 0.0});
}

}  // namespace
}  // namespace fpbm::test::saturation_laws
