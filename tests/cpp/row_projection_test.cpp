#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "fpbm/limits/detail/row_projection.hpp"
#include "fpbm/limits/detail/smallest_task_change.hpp"
#include "fpbm/limits/limiter.hpp"
#include "support/random.hpp"

/// The motion that satisfies the rows and changes a task least.
namespace fpbm::test::row_projection_laws {
namespace {

constexpr int kRows = 6;

/// Optimality conditions of the problem: u − desired = −H⁻¹ Gᵀλ with λ ≥ 0, and λ = 0 for inactive rows. Rows may be
/// equal, or parallel to rows of the task.
template <typename Scalar>
void expect_optimal(double tolerance) {
  int met = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(20000)); ++seed) {
    Random random(seed);
    constexpr int kJoints = 7;
    const Matrix<3, kJoints, Scalar> J = random.uniform(3, kJoints, -1.0, 1.0).cast<Scalar>();
    const Scalar mu = static_cast<Scalar>(seed % 2 == 0 ? 1e-2 : 1e-4) * J.squaredNorm();
    Rows<kJoints, kRows, Scalar> rows;
    rows.count = static_cast<Eigen::Index>(seed % (kRows + 1));
    const Vector<kJoints, Scalar> inside = random.uniform(kJoints, -1.0, 1.0).cast<Scalar>();
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      rows.g.col(k) = random.uniform(kJoints, -1.0, 1.0).cast<Scalar>();
      if (k == 1 && seed % 5 == 0) rows.g.col(k) = rows.g.col(0);
      if (k == 2 && seed % 3 == 0) rows.g.col(k) = J.row(0).transpose();
      if (k == 3 && seed % 4 == 0) rows.g.col(k) = -rows.g.col(0);
      rows.b(k) = rows.g.col(k).dot(inside) + static_cast<Scalar>(k % 2 == 0 ? 0.0 : random.uniform(0.0, 0.3));
    }
    const Vector<kJoints, Scalar> desired = random.uniform(kJoints, -5.0, 5.0).cast<Scalar>();
    Matrix<3, 3, Scalar> B = mu * Matrix<3, 3, Scalar>::Identity();
    if (seed % 7 < 3) {
      const Vector<3, Scalar> cheap = random.uniform(3, -1.0, 1.0).cast<Scalar>();
      B += Scalar(30) * mu * cheap * cheap.transpose();
    }
    RowProjection<3, kJoints, kRows, Scalar> projection(J, B, rows);
    const Vector<kJoints, Scalar> u = projection(desired);
    ASSERT_TRUE(projection.solved) << "seed " << seed;

    Eigen::MatrixXd G(rows.count, kJoints);
    Eigen::VectorXd excess(rows.count);
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      G.row(k) = rows.g.col(k).transpose().template cast<double>();
      excess(k) = static_cast<double>(rows.excess(k, u));
      ASSERT_LE(excess(k), tolerance) << "seed " << seed;
    }
    const Eigen::MatrixXd Jd = J.template cast<double>();
    const Eigen::Matrix3d prices = static_cast<double>(mu) * B.template cast<double>().inverse();
    const Eigen::MatrixXd H = Jd.transpose() * prices * Jd + static_cast<double>(mu) * Eigen::MatrixXd::Identity(7, 7);
    const Eigen::VectorXd force = H * (desired - u).template cast<double>();  // Gᵀλ
    // The smallest remainder of `force` after subtracting multiples of active rows, by cycling through the rows.
    Eigen::VectorXd left = force;
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(rows.count);
    for (int round = 0; round < 20000 && left.norm() > tolerance * force.norm() / 10.0; ++round) {
      for (Eigen::Index k = 0; k < rows.count; ++k) {
        if (excess(k) < -tolerance) continue;
        const double to = std::max(lambda(k) + G.row(k).dot(left) / G.row(k).squaredNorm(), 0.0);
        left -= (to - lambda(k)) * G.row(k).transpose();
        lambda(k) = to;
      }
    }
    ASSERT_LE(left.norm(), tolerance * (1.0 + force.norm())) << "seed " << seed;
    met += projection.active() != 0;
  }
  EXPECT_GE(met, trials(10000));
}

TEST(RowProjection, is_optimal) {
  expect_optimal<double>(1e-7);
  expect_optimal<float>(2e-2);
}

/// Contradictory rows admit no motion: the projection reports the contradiction and returns finite numbers.
TEST(RowProjection, reports_contradictory_rows) {
  Rows<7, 2> rows;
  rows.g.col(0) = Vector<7>::Ones();
  rows.g.col(1) = -Vector<7>::Ones();
  rows.b << -1.0, -1.0;
  rows.count = 2;
  const Matrix<3, 7> J = Random(1).uniform(3, 7, -1.0, 1.0);
  RowProjection<3, 7, 2, double> projection(J, 1e-3 * Matrix<3, 3>::Identity(), rows);
  EXPECT_TRUE(projection(Vector<7>::Zero()).allFinite());
  EXPECT_FALSE(projection.solved);
}

/// A surface ahead of the tip changes the task only along its normal, for all other rows of the same surface.
TEST(SmallestTaskChange, is_along_a_surface_s_normal) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(2000)); ++seed) {
    Random random(seed);
    const Matrix<3, 7> J = random.uniform(3, 7, -1.0, 1.0);
    const Vector<3> normal = random.uniform(3, -1.0, 1.0).normalized();
    const Vector<7> desired = random.uniform(7, -1.0, 1.0);
    Rows<7, 2> rows;
    rows.g.col(0) = J.transpose() * normal;
    rows.b(0) = rows.g.col(0).dot(desired) - 1.0;
    rows.g.col(1) = rows.g.col(0) + random.uniform(7, -0.3, 0.3);
    rows.b(1) = rows.g.col(1).dot(desired) - 0.3;
    rows.count = 1 + seed % 2;
    const double mu = 1e-12;
    const Vector<3> second = (J * J.transpose()).inverse() * J * rows.g.col(1);
    if (second.dot(normal) < 0.3) continue;  // The change for the first row is not sufficient for the second row.
    const Vector<3> change = smallest_task_change(J, mu, rows, desired).delta;
    EXPECT_LE((change + normal).norm(), 1e-9) << "seed " << seed;
    const Matrix<Eigen::Dynamic, Eigen::Dynamic> open_J = J;
    const Rows<Eigen::Dynamic, 2> open_rows{rows.g, rows.b, rows.count};
    const Vector<Eigen::Dynamic> open_change =
        smallest_task_change(open_J, mu, open_rows, Vector<Eigen::Dynamic>(desired)).delta;
    EXPECT_LE((change - open_change).norm(), 1e-12) << "seed " << seed;
  }
}

/// Share of the correction that is null-space motion: 1 if the row does not move the task, 0 if the row only moves the
/// task.
TEST(SmallestTaskChange, has_the_fraction_of_null_space_motion) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(200)); ++seed) {
    Random random(seed);
    const Matrix<3, 7> J = random.uniform(3, 7, -1.0, 1.0);
    const Vector<7> any = random.uniform(7, -1.0, 1.0);
    const Matrix<7, 3> inverse = J.transpose() * (J * J.transpose()).inverse();
    const Vector<7> within = any - inverse * (J * any);
    for (const Vector<7>& g : {any, Vector<7>(any - within), Vector<7>(within + 0.1 * any)}) {
      Rows<7, 1> rows;
      rows.g = g;
      rows.b(0) = -1.0;
      rows.count = 1;
      const double expected = (g - inverse * (J * g)).squaredNorm() / g.squaredNorm();
      EXPECT_NEAR(smallest_task_change(J, 1e-14, rows, Vector<7>(Vector<7>::Zero())).null_space_fraction, expected,
                  1e-8)
          << "seed " << seed;
    }
  }
}

/// If the rows admit the motion, or no change of the task helps, the change of the task is zero.
TEST(SmallestTaskChange, is_zero_if_rows_admit_the_motion) {
  const Matrix<3, 7> J = Random(1).uniform(3, 7, -1.0, 1.0);
  Rows<7, 2> rows;
  rows.g = Random(2).uniform(7, 2, -1.0, 1.0);
  rows.b.setConstant(100.0);
  rows.count = 2;
  EXPECT_EQ(smallest_task_change(J, 1e-3, rows, Vector<7>(Vector<7>::Ones())).delta, Vector<3>(Vector<3>::Zero()));
  rows.g.setZero();
  rows.b.setConstant(-1.0);
  EXPECT_EQ(smallest_task_change(J, 1e-3, rows, Vector<7>(Vector<7>::Ones())).delta, Vector<3>(Vector<3>::Zero()));
  EXPECT_EQ(smallest_task_change(Matrix<3, 7>(Matrix<3, 7>::Zero()), 0.0, rows, Vector<7>(Vector<7>::Ones())).delta,
            Vector<3>(Vector<3>::Zero()));
}

/// Without limits, the limited motion satisfies the rows, and the task scale is 1 minus the relative change of the
/// task. Changes of up to 1 % do not reduce the scale.
TEST(LimiterRows, scale_the_task_by_its_relative_change) {
  constexpr int kJoints = 7;
  const Limiter<Level::kAcceleration, kJoints> limiter(
      Limits<Level::kAcceleration, kJoints>(JointLimits<kJoints>::none(kJoints), 1e-3));
  const Vector<kJoints> zero = Vector<kJoints>::Zero();
  int reduced = 0;
  int full = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(2000)); ++seed) {
    Random random(seed);
    const Matrix<3, kJoints> J = random.uniform(3, kJoints, -1.0, 1.0);
    const Vector<kJoints> desired = random.uniform(kJoints, -5.0, 5.0);
    Rows<kJoints, kRows> rows;
    rows.count = static_cast<Eigen::Index>(1 + seed % 3);
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      rows.g.col(k) = seed % 2 == 0 ? Vector<kJoints>(J.transpose() * random.uniform(3, -1.0, 1.0))
                                    : Vector<kJoints>(random.uniform(kJoints, -1.0, 1.0));
      rows.b(k) = rows.g.col(k).dot(desired) - random.uniform(-1.0, 3.0);
    }
    const auto found = limiter.motion(J, State<kJoints>{zero, zero}, desired, zero, rows);
    for (Eigen::Index k = 0; k < rows.count; ++k) ASSERT_LE(rows.excess(k, found.u), 1e-7) << "seed " << seed;
    const double change = (J * (found.u - desired)).norm() / (J * desired).norm();
    const double expected = change <= 0.01 ? 1.0 : std::max(1.0 - change, 0.0);
    ASSERT_NEAR(found.scale, expected, 1e-9) << "seed " << seed;
    (expected < 1.0 ? reduced : full) += 1;
  }
  EXPECT_GT(reduced, trials(2000) / 8);
  EXPECT_GT(full, trials(2000) / 8);
}

}  // namespace
}  // namespace fpbm::test::row_projection_laws
