#include <gtest/gtest.h>

#include "fpbm/geometry/space.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/random.hpp"

/// A number of rows that is known at run time: the motions equal the motions with a fixed number of rows.
namespace fpbm::test::run_time_rows {
namespace {

constexpr int kDynamic = Eigen::Dynamic;
constexpr int kDof = 7;

template <int M>
struct Problem {
  Kinematics<Position<M>, kDynamic> kinematics;
  Reference<Position<M>> reference;
};

/// The same problem with run-time rows.
template <int M>
[[nodiscard]] Problem<kDynamic> at_run_time(const Problem<M>& problem) {
  return {{problem.kinematics.tip, problem.kinematics.J, problem.kinematics.Jd, problem.kinematics.length},
          {problem.reference.x, problem.reference.xd, problem.reference.xdd}};
}

/// rank: the last rows repeat the first rows, plus 1e-3 of a random row.
template <int M>
[[nodiscard]] Problem<M> random_problem(Random& random, int rank) {
  const auto matrix = [&] {
    Matrix<M, kDynamic> A(M, kDof);
    for (Eigen::Index i = 0; i < A.size(); ++i) A(i) = random.uniform(-1.0, 1.0);
    return A;
  };
  Problem<M> problem{{random.uniform(M, -1.0, 1.0), matrix(), matrix(), 1.0},
                     {random.uniform(M, -1.0, 1.0), random.uniform(M, -1.0, 1.0), random.uniform(M, -1.0, 1.0)}};
  auto& J = problem.kinematics.J;
  for (int i = rank; i < M; ++i) J.row(i) = (J.row(i % rank) + 1e-3 * J.row(i)).eval();
  return problem;
}

template <typename Scheme, int M>
void expect_same(const Scheme& scheme, const Problem<M>& problem, const State<kDynamic>& state) {
  const Problem<kDynamic> other = at_run_time(problem);
  Vector<kDynamic> expected = Vector<kDynamic>::Zero(kDof);
  Vector<kDynamic> u = expected;
  EXPECT_EQ(scheme.resolve(problem.kinematics, problem.reference, state, expected),
            scheme.resolve(other.kinematics, other.reference, state, u));
  EXPECT_LT((u - expected).norm(), 1e-9 * (1.0 + expected.norm())) << M << " rows";
}

template <int M>
void expect_same_motions() {
  Random random(M);
  int damped = 0;
  for (int trial = 0; trial < trials(50); ++trial) {
    const int rank = trial % 2 == 0 ? M : (M + 1) / 2;
    const Problem<M> problem = random_problem<M>(random, rank);
    const State<kDynamic> state{random.uniform(kDof, -1.0, 1.0), random.uniform(kDof, -1.0, 1.0)};
    const DiagonalWeights<kDynamic> weights(Vector<kDynamic>(random.uniform(kDof, 1.0, 4.0)));
    const auto damping = NullSpace<kDynamic>().with_damping(2.0);
    const SingularDamping<> singular(0.02, 10.0);
    for (const double alpha : {0.0, 0.6, 1.0}) {
      expect_same(AccelerationScheme<kDynamic>(alpha, weights, 10.0, 25.0, damping, singular), problem, state);
      expect_same(AccelerationScheme<kDynamic>(alpha, weights, 0.0, 0.0, damping, singular), problem, state);
    }
    expect_same(VelocityScheme<kDynamic>(weights, 3.0, NullSpace<kDynamic>(), singular), problem, state);
    Vector<kDynamic> u;
    damped += VelocityScheme<kDynamic>(weights, 3.0, NullSpace<kDynamic>(), singular)
                          .resolve(problem.kinematics, problem.reference, state, u) == Status::kDamped
                  ? 1
                  : 0;
  }
  EXPECT_EQ(damped > 0, M > 1);
}

TEST(RunTimeRows, have_the_motions_of_fixed_rows) {
  expect_same_motions<1>();
  expect_same_motions<2>();
  expect_same_motions<5>();
  expect_same_motions<6>();
}

}  // namespace
}  // namespace fpbm::test::run_time_rows
