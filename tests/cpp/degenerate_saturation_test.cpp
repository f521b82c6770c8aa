#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fpbm/limits/detail/saturation.hpp"
#include "fpbm/linalg/detail/level_space.hpp"
#include "support/linear_program.hpp"
#include "support/random.hpp"

/// Degenerate problems of the saturation: the start motion is on several bounds, several joints meet their bounds in
/// one step, or joints hardly move the tip or hardly move in the null space. The task scale equals the result of a
/// linear program.
namespace fpbm::test::degenerate_saturation_laws {
namespace {

/// Number of problems of each kind and size. FPBM_DEGENERATE sets another number: with 2000, there are 11 × 5 × 2000 =
/// 110,000 problems.
[[nodiscard]] int problems_of_each_kind() {
  const char* number = std::getenv("FPBM_DEGENERATE");
  return number != nullptr ? std::atoi(number) : trials(300);
}

struct Problem {
  Eigen::MatrixXd J;
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  Eigen::VectorXd rest;
  Eigen::VectorXd desired;
};

template <int M, int N>
[[nodiscard]] SaturatedMotion<N> saturate(const Problem& p) {
  const Vector<N> unit = Vector<N>::Ones(p.J.cols());
  NullSpaceSaturation<M, N, double> saturation(Matrix<M, N>(p.J), unit);
  return saturation(Box<N>{p.lower, p.upper}, Vector<N>(p.rest), Vector<N>(p.desired));
}

/// A Jacobian whose null space has the columns of Z as a basis.
[[nodiscard]] Eigen::MatrixXd with_null_space(const Eigen::MatrixXd& Z) {
  return Eigen::FullPivLU<Eigen::MatrixXd>(Z.transpose()).kernel().transpose();
}

/// Sets `rest` to bounds for some joints. For these joints, the goal stays, is inside the bounds, or exceeds the bound
/// by `beyond`.
void put_on_bounds(Random& random, Problem& p, double beyond) {
  for (Eigen::Index i = 0; i < p.rest.size(); ++i) {
    const double draw = random.uniform(0.0, 1.0);
    if (draw > 0.7) continue;
    const double outward = draw < 0.35 ? -1.0 : 1.0;
    p.rest(i) = outward < 0.0 ? p.lower(i) : p.upper(i);
    const double goal = random.uniform(0.0, 1.0);
    if (goal < 0.6) p.desired(i) = p.rest(i) + outward * beyond;
    if (goal > 0.8) p.desired(i) = p.rest(i) - outward * random.uniform(0.0, 0.5);
  }
}

[[nodiscard]] Problem make(const std::string& kind, Eigen::Index m, Eigen::Index n, Random& random) {
  Problem p{random.uniform(m, n, -1.0, 1.0),
            random.uniform(n, -1.0, -0.2),
            random.uniform(n, 0.2, 1.0),
            random.uniform(n, -0.2, 0.2),
            {}};
  p.desired = std::pow(10.0, random.uniform(-0.5, 0.5)) * random.uniform(n, -1.0, 1.0);
  const auto j = static_cast<Eigen::Index>(random.uniform(0.0, static_cast<double>(n) - 1e-3));
  const double small = std::pow(10.0, random.uniform(-11.0, -7.0));
  if (kind == "on bounds") put_on_bounds(random, p, 0.0);
  if (kind == "beyond bounds by round-off") put_on_bounds(random, p, 2e-16);
  if (kind == "on bounds, goal on bounds") {
    p.desired = p.desired.cwiseMin(p.upper).cwiseMax(p.lower);
    put_on_bounds(random, p, 0.0);
    p.desired(j) = 3.0;
  }
  if (kind == "ties") {
    p.lower.setConstant(-0.5);
    p.upper.setConstant(0.5);
    p.rest = 0.5 * random.uniform(n, -1.5, 1.5).array().round();
    for (double& entry : p.desired) entry = std::round(2.0 * entry) / 2.0;
    for (double& entry : p.J.reshaped()) entry = std::round(2.0 * entry) / 2.0;
  }
  if (kind == "idle joint") p.J.col(j) *= small;
  if (kind == "idle joint, on bounds") {
    p.J.col(j) *= small;
    put_on_bounds(random, p, 0.0);
  }
  if (kind.find("small entries") == 0) {
    Eigen::MatrixXd Z = random.uniform(n, n - m, -1.0, 1.0);
    // For goals as small as the entries, the round-off error of the null space, 1e-16, would decide the result.
    const double least = kind == "small entries, small goals" ? -9.0 : -11.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (random.uniform(0.0, 1.0) < 0.4) Z.row(i) *= std::pow(10.0, random.uniform(least, -7.0));
    }
    p.J = with_null_space(Z);
    if (kind == "small entries, on bounds") put_on_bounds(random, p, 0.0);
    if (kind == "small entries, small goals") {
      put_on_bounds(random, p, 0.0);
      for (Eigen::Index i = 0; i < n; ++i) {
        if (Z.row(i).norm() < 1e-6) p.desired(i) = p.rest(i) + Z.row(i).norm() * random.uniform(-0.3, 0.3);
      }
    }
  }
  if (kind == "repeated columns") {
    p.J.col(j) = p.J.col((j + 1) % n).eval();
    put_on_bounds(random, p, 0.0);
  }
  if (kind == "dependent rows of the null space") {
    Eigen::MatrixXd Z = random.uniform(n, n - m, -1.0, 1.0);
    for (Eigen::Index i = 2; i < std::min<Eigen::Index>(4, n); ++i) {
      Z.row(i) = random.uniform(-1.0, 1.0) * Z.row(0) + random.uniform(-1.0, 1.0) * Z.row(1);
    }
    p.J = with_null_space(Z);
    put_on_bounds(random, p, 0.0);
  }
  return p;
}

template <int M, int N>
void check(const std::string& kind, Eigen::Index m, Eigen::Index n, int& all, int& below, int& most_passes,
           double& worst) {
  Random random(31);
  for (int k = 0; k < problems_of_each_kind(); ++k) {
    const Problem p = make(kind, m, n, random);
    const SaturatedMotion<N> found = saturate<M, N>(p);
    SCOPED_TRACE(kind + ", " + std::to_string(m) + " × " + std::to_string(n) + ", problem " + std::to_string(k));
    ASSERT_TRUE((p.lower.array() <= found.u.array()).all() && (found.u.array() <= p.upper.array()).all());
    const Eigen::VectorXd task = p.J * (p.desired - p.rest);
    const Eigen::VectorXd done = p.J * (found.u - p.rest);
    ASSERT_LE((done - found.scale * task).norm(), 1e-9 * found.scale * task.norm() + 1e-11 * p.J.norm());
    // Due to the round-off error of the bounds, the optimum of some problems is uncertain.
    const auto optimum = [&](double slack) {
      const Eigen::VectorXd wider = Eigen::VectorXd::Constant(n, slack);
      return largest_scale(p.J, p.lower - wider, p.upper + wider, p.rest, p.desired, {}, {});
    };
    const double wider = optimum(1e-12);
    const double exact = optimum(0.0);
    const double most = kind == "beyond bounds by round-off" ? wider : exact - std::abs(wider - exact);
    ++all;
    most_passes = std::max(most_passes, found.passes);
    worst = std::max(worst, most - found.scale);
    if (found.scale < most - 1e-6) {
      ++below;
      std::printf("  %d × %d, problem %d: s = %.9g of %.9g\n", int(m), int(n), k, found.scale, most);
    }
  }
}

TEST(DegenerateSaturation, is_optimal) {
  for (const char* kind : {"on bounds", "beyond bounds by round-off", "on bounds, goal on bounds", "ties", "idle joint",
                           "idle joint, on bounds", "small entries", "small entries, on bounds",
                           "small entries, small goals", "repeated columns", "dependent rows of the null space"}) {
    int all = 0;
    int below = 0;
    int passes = 0;
    double worst = 0.0;
    check<2, 4>(kind, 2, 4, all, below, passes, worst);
    check<6, 7>(kind, 6, 7, all, below, passes, worst);
    constexpr int X = Eigen::Dynamic;
    check<X, X>(kind, 3, 7, all, below, passes, worst);
    check<X, X>(kind, 6, 8, all, below, passes, worst);
    check<X, X>(kind, 3, 4, all, below, passes, worst);
    std::printf("%s: %d problems, %d below the linear program by more than 1e-6 (worst %.1e), %d passes at most\n",
                kind, all, below, worst, passes);
    EXPECT_EQ(below, 0) << kind;
  }
}

/// A basis of a null space has round-off errors, which must not move other joints. If a joint without null-space motion
/// must leave its bound by 1e-14, the task is blocked.
TEST(DegenerateSaturation, round_off_error_of_the_basis_moves_no_joint) {
  LevelSpace<3> space(3);
  Matrix<2, 3> levels;
  levels << 1.0, 0.0, 0.0, 0.0, 1.0, 2e-15;  // Null space: (0, −2e-15, 1).
  space.add(levels);
  NullSpaceSaturation<Eigen::Dynamic, 3, double> saturation(space, Vector<3>::Ones());
  const Box<3> box{Vector<3>(-1.0, 0.0, -0.04), Vector<3>(1.0, 1.0, 0.0)};
  const auto found = saturation(box, Vector<3>::Zero(), Vector<3>(0.0, -8e-15, 0.003));
  EXPECT_EQ(found.u(2), 0.0);
}

}  // namespace
}  // namespace fpbm::test::degenerate_saturation_laws
