#include "fpbm/linalg/detail/self_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "fpbm/linalg/detail/row_factor.hpp"
#include "support/make_subjects.hpp"

/// Factorisations of J without JJᵀ, by its one self-motion and by its rows, compared with pseudoinverses in extended
/// precision: the condition number of J enters the round-off error once.
namespace fpbm::test::self_motion_laws {
namespace {

/// J with M rows, of which the last kTurns_ are angular, and N joints.
template <int M_, int N_, int kTurns_, typename Scalar_ = double>
struct Shape {
  static constexpr int M = M_;
  static constexpr int N = N_;
  static constexpr int kTurns = kTurns_;
  using Scalar = Scalar_;
};

struct ShapeNames {
  template <typename Shape>
  static std::string GetName(int) {
    const std::string size = "m" + std::to_string(Shape::M) + "_n" + std::to_string(Shape::N);
    return std::is_same_v<typename Shape::Scalar, float> ? size + "_float" : size;
  }
};

/// Random J whose smallest singular value is near `least`: the last of its linear rows is nearly equal to another row.
/// Axes are unit vectors.
template <typename Shape>
Matrix<Shape::M, Shape::N, typename Shape::Scalar> random_jacobian(Random& random, double least) {
  constexpr int kLengths = Shape::M - Shape::kTurns;
  Eigen::MatrixXd J = random.uniform(Shape::M, Shape::N, -1.0, 1.0);
  if (Shape::kTurns > 0) J.bottomRows(Shape::kTurns).colwise().normalize();
  J.row(kLengths - 1) = J.row(0) + least * random.uniform(Shape::N, -1.0, 1.0).transpose();
  return J.cast<typename Shape::Scalar>();
}

template <typename Shape>
struct Factors : ::testing::Test {
  using Scalar = typename Shape::Scalar;
  static constexpr double kEpsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());

  /// Calls check(J, random, round_off). round_off: relative to the result.
  template <typename Check>
  static void everywhere(Check&& check) {
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      const auto J =
          random_jacobian<Shape>(random, std::pow(10.0, random.uniform(kEpsilon < 1e-10 ? -5.0 : -2.0, 0.0)));
      const RealVector sigma = singular_values(real(J));
      const auto condition = static_cast<double>(sigma(0) / sigma(sigma.size() - 1));
      check(J, random, 256.0 * kEpsilon * condition);
    }
  }

  static double distance(const RealVector& a, const RealVector& b) {
    return static_cast<double>((a - b).norm() / (b.norm() + static_cast<Real>(1e-300)));
  }
};

template <typename Shape>
struct SelfMotions : Factors<Shape> {};
#ifdef FPBM_FEW_TYPES
using WithSelfMotion = ::testing::Types<Shape<2, 3, 0>, Shape<6, 7, 3, float>>;
using OfRows = ::testing::Types<Shape<3, 7, 0, float>, Shape<6, 6, 3>>;
#else
using WithSelfMotion = ::testing::Types<Shape<2, 3, 0>, Shape<3, 4, 1>, Shape<5, 6, 2>, Shape<5, 6, 2, float>,
                                        Shape<6, 7, 3>, Shape<6, 7, 3, float>>;
using OfRows = ::testing::Types<Shape<2, 4, 0>, Shape<3, 7, 0>, Shape<6, 6, 3>, Shape<6, 9, 3>, Shape<3, 7, 0, float>>;
#endif
TYPED_TEST_SUITE(SelfMotions, WithSelfMotion, ShapeNames);

/// J v = 0; J y = b, for one b and for two; sᵀg for J s = t equals tᵀμ for Jᵀμ = g; the trace of (JJᵀ)⁻¹; and the
/// bounds are below σ_min.
TYPED_TEST(SelfMotions, are_found_with_every_kind_of_factor) {
  using S = typename TypeParam::Scalar;
  constexpr int M = TypeParam::M;
  constexpr int N = TypeParam::N;
  using Motion = SelfMotion<M, N, S>;
  int found[Motion::kKinds] = {};
  this->everywhere([&](const Matrix<M, N, S>& J, Random& random, double round_off) {
    const RealMatrix exact = real(J);
    for (int kind = 0; kind < Motion::kKinds; ++kind) {
      Motion motion;
      if (!motion.factor(J, kind)) continue;
      ++found[kind];
      const RealVector v = real(motion.null());
      EXPECT_LE(static_cast<double>((exact * v).norm()), round_off * static_cast<double>(exact.norm() * v.norm()));

      const Vector<M, S> b = random.uniform(M, -1.0, 1.0).template cast<S>();
      const Vector<M, S> c = random.uniform(M, -1.0, 1.0).template cast<S>();
      const Vector<N, S> y = motion.solve(b);
      EXPECT_LE(static_cast<double>((exact * real(y) - real(b)).norm()),
                round_off * static_cast<double>(exact.norm() * real(y).norm()));
      const Vector<N, Pair<S>> both = motion.solve(side_by_side<M, 1, S>(b, c));
      const Vector<N, S> alone = motion.solve(c);
      EXPECT_LE(this->distance(real(first<N, 1, S>(both)), real(y)), round_off);
      EXPECT_LE(this->distance(real(second<N, 1, S>(both)), real(alone)), round_off);

      const RealVector mu = real(random.uniform(M, -1.0, 1.0));
      const Vector<N, S> g = RealVector(exact.transpose() * mu).template cast<S>();
      const RealVector s = pseudoinverse(exact) * real(b);
      const auto size = static_cast<double>(s.norm() * real(g).norm());
      EXPECT_NEAR(static_cast<double>(motion.along(b, g)), static_cast<double>(s.dot(g.template cast<Real>())),
                  round_off * size);

      for (const double length : {0.3, 1.0, 4.0}) {
        RealMatrix metres = exact;
        metres.bottomRows(TypeParam::kTurns) *= static_cast<Real>(length);
        const auto least = static_cast<double>(singular_values(metres)(M - 1));
        const S exactly = motion.inverse_square(static_cast<S>(length));
        EXPECT_LE(1.0, (1.0 + round_off) * static_cast<double>(exactly) * least * least);
        EXPECT_LE(exactly, (1.0 + round_off) * motion.rough_inverse_square(static_cast<S>(length)));
      }
    }
  });
  for (const int count : found) EXPECT_GT(count, 20);
}

template <typename Shape>
struct RowFactors : Factors<Shape> {};
TYPED_TEST_SUITE(RowFactors, OfRows, ShapeNames);

/// A⁺b, and a motion without its component in the span of the rows of A.
TYPED_TEST(RowFactors, solve_without_the_square_of_the_condition) {
  using S = typename TypeParam::Scalar;
  constexpr int M = TypeParam::M;
  constexpr int N = TypeParam::N;
  this->everywhere([&](const Matrix<M, N, S>& A, Random& random, double round_off) {
    RowFactor<M, N, S> factor;
    if (factor.factor(A.transpose()) != Status::kOk) FAIL();
    const RealMatrix inverse = pseudoinverse(real(A));
    const Vector<M, S> b = random.uniform(M, -1.0, 1.0).template cast<S>();
    const Vector<N, S> a = random.uniform(N, -1.0, 1.0).template cast<S>();
    const RealVector least = inverse * real(b);
    EXPECT_LE(this->distance(real(factor.combine(factor.coefficients(b))), least), round_off);
    const RealVector left = real(a) - inverse * (real(A) * real(a));
    EXPECT_LE(static_cast<double>((real(factor.project(a)) - left).norm()), round_off * static_cast<double>(a.norm()));
    const RealVector force = inverse.transpose() * least;
    const auto size = static_cast<double>(inverse.norm() * least.norm());
    EXPECT_LE(static_cast<double>((real(factor.back_substitute(factor.coefficients(b))) - force).norm()),
              round_off * size);
    const auto trace = static_cast<double>(inverse.squaredNorm());
    EXPECT_NEAR(static_cast<double>(factor.inverse_trace()), trace, round_off * trace);
  });
}

/// A row that equals another row is lost, for every size. Entries that are not finite are not reported as singular.
TYPED_TEST(RowFactors, report_singular_matrices) {
  using S = typename TypeParam::Scalar;
  constexpr int M = TypeParam::M;
  constexpr int N = TypeParam::N;
  this->everywhere([&](Matrix<M, N, S> A, Random&, double) {
    RowFactor<M, N, S> factor;
    for (const double share : {1.0, 0.0, 1e-12}) {
      A.row(M - 1) = static_cast<S>(share) * A.row(0);
      EXPECT_EQ(factor.factor(A.transpose()), Status::kSingular);
      Matrix<M, N, S> turned = A;
      turned.row(0).swap(turned.row(M - 1));
      EXPECT_EQ(factor.factor(turned.transpose()), Status::kSingular);
    }
    A(0, 1) = std::numeric_limits<S>::infinity();
    EXPECT_EQ(factor.factor(A.transpose()), Status::kNotFinite);
  });
}

/// Every scheme on a planar arm of three joints, which the laws of schemes do not cover.
class ThreeJoints : public ::testing::TestWithParam<Subject> {};

/// The law p + γ v equals the textbook, and damping changes no bit outside its radius, at any distance.
TEST_P(ThreeJoints, move_by_the_law_of_one_self_motion) {
  for (const bool has_null_space : {false, true}) {
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      const Scene scene = random_scene(random, GetParam(), seed % 2 == 0 ? Regime::kRegular : Regime::kNearSingular);
      Law law = random_law(random, GetParam(), has_null_space);
      const Outcome plain = GetParam().resolve(law, scene);
      ASSERT_EQ(plain.status, Status::kOk);
      const RealVector sigma = singular_values(plain.at.J);
      const auto condition = static_cast<double>(sigma(0) / sigma(1));
      const RealVector expected = resolve(law, plain.at);
      const RealVector drift = rate_term(plain.at.J, plain.at.Jd, real(law.W)) * plain.at.xd;
      const auto size =
          static_cast<double>(expected.norm() + (pseudoinverse(plain.at.J) * commanded(law, plain.at)).norm() +
                              secondary(law, plain.at).norm() + drift.norm());
      EXPECT_LE(static_cast<double>((plain.u - expected).norm()), 256.0 * GetParam().epsilon * condition * size);
      for (const double share : {0.01, 0.5, 0.9, 1.0 - 1e-9}) {
        law.singular_radius = share * static_cast<double>(sigma(1) / plain.at.J.norm());
        const Outcome damped = GetParam().resolve(law, scene);
        EXPECT_EQ(damped.status, Status::kOk);
        const Eigen::VectorXd a = plain.u.cast<double>();
        const Eigen::VectorXd b = damped.u.cast<double>();
        EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(double) * 3), 0) << share;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(every, ThreeJoints, ::testing::ValuesIn(make_subjects<PlanarArm<3>, Position<2>>("n3", 3)),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace fpbm::test::self_motion_laws
