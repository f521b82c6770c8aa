#include "fpbm/singular/damping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "support/paper.hpp"
#include "support/recording.hpp"
#include "support/subjects.hpp"

/// Damping near singular postures, for every scheme on every arm and on the Panda, compared with singular value
/// decompositions in extended precision.
namespace fpbm::test::damping_laws {
namespace {

/// A subject and a posture in which it is singular for every angle of the first joint.
struct Place {
  Subject subject;
  Eigen::VectorXd singular;
};

void PrintTo(const Place& place, std::ostream* out) {
  *out << place.subject.name;
}

std::vector<Place> places() {
  std::vector<Place> all;
  // Stretched arms. Arms in space lose two directions of a position, or three rows of a pose.
  for (const Subject& subject : subjects()) all.push_back({subject, Eigen::VectorXd::Zero(subject.dof)});
  // Stretched: joints 2, 4, 6 and the flange on a line, with the offsets of 82.5 and 88 mm on either side.
  const double elbow = -std::atan2(0.0825, 0.316) - std::atan2(0.0825, 0.384);
  const double wrist = kPi + std::atan2(0.0825, 0.384) - std::atan2(0.088, 0.107);
  const Eigen::VectorXd stretched = Eigen::Vector<double, 7>(0.0, -0.4, 0.0, elbow, 0.0, wrist, 0.3);
  for (const Subject& subject : panda_position_subjects()) all.push_back({subject, stretched});
  // Upright: the axes of joints 1, 3 and 5 coincide.
  for (const Subject& subject : panda_pose_subjects()) all.push_back({subject, Eigen::VectorXd::Zero(7)});
  return all;
}

/// The places of subjects in double: for second differences, the round-off error of float is too large.
std::vector<Place> places_in_double() {
  std::vector<Place> all = places();
  all.erase(std::remove_if(all.begin(), all.end(), [](const Place& each) { return each.subject.epsilon > 1e-10; }),
            all.end());
  return all;
}

double least_singular_value(const RealMatrix& J) {
  return static_cast<double>(singular_values(J).tail(1)(0));
}

/// σ_min / ‖J‖_F, with angles scaled by the length of the arm: the smallest radius with which J is damped.
double distance_to_singular(const Situation& at) {
  const RealMatrix even = at.units.asDiagonal() * at.J;
  return least_singular_value(even) / static_cast<double>(even.norm());
}

/// Δ / ε² by its definition; its trace is the number of lost directions.
RealMatrix lost_directions(const RealMatrix& J, double radius) {
  const Real edge = static_cast<Real>(radius) * J.norm();
  const auto [sigma, U] = spectrum(J);
  RealMatrix lost = RealMatrix::Zero(J.rows(), J.rows());
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    const Real ratio = sigma(i) / edge;
    if (ratio < 1) lost += std::pow(1 - ratio * ratio, Real(3)) * U.col(i) * U.col(i).transpose();
  }
  return lost;
}

/// N_W z times Π (1 − (1 − s²)³) of all s = σ/(0.1 ε) below 1.
RealVector free_motion(const RealMatrix& J, const RealMatrix& W, double radius, const RealVector& z) {
  const Real edge = static_cast<Real>(0.1 * radius) * J.norm();
  Real scale = 1;
  for (const Real sigma : spectrum(J).sigma) {
    const Real ratio = sigma / edge;
    if (ratio < 1) scale *= 1 - std::pow(1 - ratio * ratio, Real(3));
  }
  // Below this scale, the inverse of JW⁻¹Jᵀ has no correct digit.
  if (!(scale > 1e-15)) return RealVector::Zero(z.size());
  return scale * (projector(J, W) * z);
}

/// The expected result of a damped scheme, and the size of the terms in its sum.
struct Expected {
  RealVector u;
  double size;
};

/// The laws as printed, with damped J⁺ and J_W⁺, and the brake in z. The part of z that depends on the posture becomes
/// free_motion(), or, if the command b is beyond the lost directions, has the damped projection.
Expected damped(const Law& law, const Situation& at) {
  const auto alpha = static_cast<Real>(law.alpha);
  const RealMatrix even = at.units.asDiagonal() * at.J;
  const RealMatrix lost = lost_directions(even, law.singular_radius);
  const Real edge = static_cast<Real>(law.singular_radius) * even.norm();
  const RealMatrix to_units = at.units.cwiseInverse().asDiagonal();
  const RealMatrix delta = edge * edge * to_units * lost * to_units;
  RealMatrix Winv = inverse(real(law.W));
  Winv /= Winv.diagonal().maxCoeff();

  const RealMatrix damped_inverse = inverse(at.J * Winv * at.J.transpose() + delta);
  const RealMatrix Jp = at.J.transpose() * inverse(at.J * at.J.transpose() + delta);
  const RealMatrix JWp = Winv * at.J.transpose() * damped_inverse;
  const RealVector b = commanded(law, at);
  Situation at_rest = at;
  at_rest.qd.setZero();
  const RealVector spring = secondary(law, at_rest);
  RealVector z = secondary(law, at) - spring;
  RealVector rate = RealVector::Zero(at.q.size());
  const RealVector command = lost * (at.units.asDiagonal() * b);
  const Real size_of_spring = std::sqrt((spring.transpose() * inverse(Winv) * spring).value()) + 1;
  const Real t = command.norm() / (edge * size_of_spring);
  const Real beyond = std::clamp((t * t - 1) / 3, Real(0), Real(1));
  const RealVector free = (1 - beyond) * free_motion(even, real(law.W), law.singular_radius, spring) +
                          beyond * (spring - JWp * at.J * spring);
  if (law.acceleration) {
    z -= static_cast<Real>(law.singular_brake) * lost.trace() * at.qd;
    rate = alpha * Winv * at.Jd.transpose() * damped_inverse * at.xd;
  }
  const RealVector v = z + rate;
  const RealVector task = (1 - alpha) * Jp * b + alpha * JWp * b;
  const Real size = (Jp.norm() + JWp.norm()) * b.norm() + (1 + JWp.norm() * at.J.norm()) * (v.norm() + spring.norm());
  return {task + v - JWp * at.J * v + free, static_cast<double>(size)};
}

/// Trials for each type of state.
constexpr std::uint32_t kSeeds = 16;

bool same_bits(const RealVector& a, const RealVector& b) {
  // Compared as double, the original type: a long double has padding bytes.
  const Eigen::VectorXd x = a.cast<double>();
  const Eigen::VectorXd y = b.cast<double>();
  return x.size() == y.size() &&
         std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) == 0;
}

class Damping : public ::testing::TestWithParam<Place> {
 protected:
  static const Subject& subject() { return GetParam().subject; }

  static Outcome resolve(const Law& law, const Scene& scene) { return subject().resolve(law, scene); }

  static Law with_radius(const Law& law, double radius, double brake = 100.0) {
    Law result = law;
    result.singular_radius = radius;
    result.singular_brake = brake;
    return result;
  }

  /// Calls check(scene, law) in states that are not singular. Some are nearly singular.
  template <typename Check>
  static void in_regular_states(Check&& check) {
    for (const Regime regime : {Regime::kRegular, Regime::kNearSingular, Regime::kAtRest}) {
      for (const bool has_null_space : {false, true}) {
        for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
          SCOPED_TRACE(name(regime) + (has_null_space ? " with z" : " without z") + ", seed " + std::to_string(seed));
          Random random(seed);
          const Scene scene = random_scene(random, subject(), regime);
          check(scene, random_law(random, subject(), has_null_space));
        }
      }
    }
  }

  /// A singular scene: stretched, or with folded joints if the folded posture is singular too.
  static Scene singular_scene(Random& random) {
    Scene scene = random_scene(random, subject(), Regime::kRegular);
    const bool foldable = GetParam().singular.isZero();
    for (Eigen::Index i = 1; i < scene.q.size(); ++i) {
      const bool folded = random.uniform(0.0, 1.0) < 0.25;
      scene.q(i) = GetParam().singular(i) + (foldable && folded ? kPi : 0.0);
    }
    return scene;
  }

  /// Calls check(scene, law) in singular states and at several distances from singular states.
  template <typename Check>
  static void around_singular_states(Check&& check) {
    for (const bool has_null_space : {false, true}) {
      for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
        SCOPED_TRACE(std::string(has_null_space ? "with z" : "without z") + ", seed " + std::to_string(seed));
        Random random(seed);
        Scene scene = singular_scene(random);
        const Law law = random_law(random, subject(), has_null_space);
        const Eigen::VectorXd direction = random.uniform(scene.q.size(), -1.0, 1.0);
        const Eigen::VectorXd singular = scene.q;
        const double radius = random.uniform(0.03, 0.2);
        for (const double distance : {0.0, 1e-15, 1e-10, 1e-6, 1e-3, 0.03, 0.1, 0.3}) {
          scene.q = singular + distance * direction;
          check(scene, with_radius(law, radius));
        }
      }
    }
  }

  /// Expected round-off error of Δ/ε², which is computed from the eigenvalues of JJᵀ.
  static double round_off(double radius) { return 64.0 * subject().epsilon / (radius * radius); }
};

/// If σ_min ≥ ε by the smallest margin, the result is bitwise the result without damping. Just below ε, the result is
/// damped.
TEST_P(Damping, is_exactly_none_outside_the_radius) {
  in_regular_states([](const Scene& scene, const Law& law) {
    const Outcome plain = resolve(law, scene);
    ASSERT_EQ(plain.status, Status::kOk);
    const double border = distance_to_singular(plain.at);
    const double hair = round_off(border);
    ASSERT_LT(hair, 0.1);
    for (const double share : {0.01, 0.5, 1.0 - hair}) {
      const Outcome outside = resolve(with_radius(law, share * border), scene);
      EXPECT_EQ(outside.status, Status::kOk) << share;
      EXPECT_TRUE(same_bits(outside.u, plain.u)) << share;
    }
    EXPECT_EQ(resolve(with_radius(law, (1.0 + hair) * border), scene).status, Status::kDamped);
  });
}

/// In every state, the result equals the law with JW⁻¹Jᵀ + Δ and the brake in the null space.
TEST_P(Damping, equals_its_definition) {
  around_singular_states([](const Scene& scene, const Law& law) {
    const Outcome outcome = resolve(law, scene);
    const double border = distance_to_singular(outcome.at);
    const double hair = round_off(law.singular_radius);
    if (std::abs(border / law.singular_radius - 1.0) > hair) {
      EXPECT_EQ(outcome.status, border < law.singular_radius ? Status::kDamped : Status::kOk);
    }
    const Expected expected = damped(law, outcome.at);
    if (subject().epsilon < 1e-10) {
      EXPECT_LE(hair, 1e-9) << "the scene is too hard for the promised 1e-9";
    }
    EXPECT_LE(static_cast<double>((outcome.u - expected.u).norm()), hair * expected.size);
  });
}

/// ‖J⁺‖ ≤ 1.17/ε: the columns of J⁺ are the results of MVN for unit velocities, with angles scaled by the length of the
/// arm.
TEST_P(Damping, bounds_the_joint_velocities) {
  if (subject().takes.acceleration || subject().takes.weights) return;
  around_singular_states([](Scene scene, Law law) {
    law.k = 0.0;
    law.has_null_space = false;
    RealMatrix Jp(scene.q.size(), scene.xd.size());
    double edge = 0.0;
    for (Eigen::Index i = 0; i < scene.xd.size(); ++i) {
      scene.xd = Eigen::VectorXd::Unit(scene.xd.size(), i);
      const Outcome outcome = resolve(law, scene);
      Jp.col(i) = outcome.u / outcome.at.units(i);
      edge = law.singular_radius * static_cast<double>((outcome.at.units.asDiagonal() * outcome.at.J).norm());
    }
    EXPECT_LE(static_cast<double>(singular_values(Jp)(0)), 1.17 / edge);
  });
}

/// The result is always finite, down to the smallest radius that the Scalar resolves.
TEST_P(Damping, has_a_finite_result) {
  around_singular_states([](const Scene& scene, const Law& law) {
    const double smallest = 32.0 * std::sqrt(subject().epsilon);
    for (const double radius : {smallest, 1e-2, 1.0}) {
      const Outcome outcome = resolve(with_radius(law, radius), scene);
      EXPECT_FALSE(failed(outcome.status)) << radius << ": " << message(outcome.status);
      EXPECT_FALSE(outcome.untouched()) << radius;
      EXPECT_TRUE(outcome.u.cast<double>().allFinite()) << radius;
    }
  });
}

/// A state or reference that is not finite is rejected, with and without damping.
TEST_P(Damping, does_not_hide_numbers_that_are_not_finite) {
  Random random(1);
  const Law law = with_radius(random_law(random, subject(), true), 0.1);
  const Scene good = singular_scene(random);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (Eigen::VectorXd Scene::*member : {&Scene::q, subject().takes.acceleration ? &Scene::qd : &Scene::xd}) {
      Scene scene = good;
      (scene.*member)(1) = bad;
      const Outcome outcome = resolve(law, scene);
      EXPECT_EQ(outcome.status, Status::kNotFinite);
      EXPECT_TRUE(outcome.untouched());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(every, Damping, ::testing::ValuesIn(places()),
                         [](const auto& each) { return each.param.subject.name; });

/// The result along a straight line of postures, q = singular + s direction, which enters the radius at s = ±kEdge.
class SmoothDamping : public Damping {
 protected:
  static constexpr double kEdge = 0.2;

  void SetUp() override {
    for (std::uint32_t seed = 0;; ++seed) {
      Random random(seed);
      scene_ = singular_scene(random);
      direction_ = random.uniform(scene_.q.size(), -1.0, 1.0);
      law_ = random_law(random, subject(), true);
      law_.alpha = std::clamp(law_.alpha, 0.1, 0.9);
      const double radius = distance_to_singular(at(kEdge).at);
      law_ = with_radius(law_, radius);
      if (radius > 0.004 && radius < 0.3) return;
    }
  }

  [[nodiscard]] Outcome at(double s) const {
    Scene scene = scene_;
    scene.q += s * direction_;
    return resolve(law_, scene);
  }

  [[nodiscard]] Eigen::VectorXd answer(double s) const { return at(s).u.cast<double>(); }

  /// Largest difference quotient over grid steps of h.
  [[nodiscard]] double steepest(double h) const {
    double steepest = 0.0;
    Eigen::VectorXd before = answer(-2.0 * kEdge);
    for (double s = -2.0 * kEdge + h; s < 2.0 * kEdge; s += h) {
      const Eigen::VectorXd here = answer(s);
      steepest = std::max(steepest, (here - before).norm() / h);
      before = here;
    }
    return steepest;
  }

  /// Difference between the second difference quotients on both sides of s.
  [[nodiscard]] double kink(double s, double h) const {
    return (answer(s + 2.0 * h) - 3.0 * answer(s + h) + 3.0 * answer(s) - answer(s - h)).norm() / (h * h);
  }

  Scene scene_;
  Law law_;
  Eigen::VectorXd direction_;
};

/// No jump: difference quotients stay bounded if the steps decrease.
TEST_P(SmoothDamping, is_continuous) {
  ASSERT_EQ(at(0.0).status, Status::kDamped);
  ASSERT_EQ(at(1.01 * kEdge).status, Status::kOk) << "the line leaves the radius";
  EXPECT_LE(steepest(5e-4), 1.25 * steepest(2e-3));
}

/// Two continuous derivatives in the singular posture, at the damping radius, and in between: the second difference
/// quotients of both sides converge if the step decreases.
TEST_P(SmoothDamping, has_two_continuous_derivatives) {
  for (const double s : {0.0, kEdge, -kEdge, 0.37 * kEdge}) {
    const double coarse = std::max({kink(s, 4e-3), kink(s, 3e-3), kink(s, 2e-3)});
    const double h = 2.5e-4;
    const double noise = 1e-11 * answer(s).norm() / (h * h);
    EXPECT_LE(kink(s, h), 0.25 * coarse + noise) << "s = " << s;
  }
}

INSTANTIATE_TEST_SUITE_P(every, SmoothDamping, ::testing::ValuesIn(places_in_double()),
                         [](const auto& each) { return each.param.subject.name; });

/// J with these singular values: U diag(sigma) Vᵀ with random U and V.
RealMatrix with_singular_values(Random& random, const RealVector& sigma, Eigen::Index n) {
  const Eigen::Index m = sigma.size();
  const RealMatrix U = orthogonal(real(random.uniform(m, m, -1.0, 1.0)));
  const RealMatrix V = orthogonal(real(random.uniform(n, n, -1.0, 1.0)));
  return U * sigma.asDiagonal() * V.leftCols(m).transpose();
}

/// W⁻¹Jᵀ(JW⁻¹Jᵀ + Δ)⁻¹.
template <int M, int N, typename Scalar, typename Weights>
RealMatrix damped_inverse(const Weights& weights, const SingularDamping<Scalar>& damping,
                          const Matrix<M, N, Scalar>& J) {
  const Matrix<N, M, Scalar> Jt = J.transpose();
  const Matrix<N, M, Scalar> rows = weights.root_transpose(Jt);
  DampedGram<M, N, Scalar> gram(damping, J, rows);
  EXPECT_FALSE(failed(gram.factor(weights.template inverse_bound<Scalar>())));
  Matrix<N, M, Scalar> inverse;
  for (int i = 0; i < M; ++i) {
    const Vector<N, Scalar> column = gram.solved(
        [i](const auto& solutions) -> Vector<N, Scalar> { return solutions.motion(Vector<M, Scalar>::Unit(i)); });
    inverse.col(i) = weights.root(column);
  }
  return real(inverse);
}

/// M singular values, N columns.
template <int M_, int N_, typename Scalar_ = double>
struct Shape {
  static constexpr int M = M_;
  static constexpr int N = N_;
  using Scalar = Scalar_;
};

template <typename Shape>
struct Spectra : ::testing::Test {
  static constexpr int M = Shape::M;
  static constexpr int N = Shape::N;
  using Number = typename Shape::Scalar;

  /// Calls check(J, random) on matrices with none, some, and all but one of their singular values below about `scale`,
  /// down to zero.
  template <typename Check>
  static void everywhere(double scale, Check&& check) {
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      RealVector sigma = real(random.uniform(M, 0.5, 2.0));
      for (std::uint32_t i = 1; i < M; ++i) {
        const std::uint32_t kind = (seed >> i) % 4;
        if (kind == 1) sigma(i) = static_cast<Real>(scale * random.uniform(0.0, 1.5));
        if (kind == 2) sigma(i) = static_cast<Real>(scale * std::pow(10.0, random.uniform(-16.0, 0.0)));
        if (kind == 3) sigma(i) = 0;
      }
      check(Matrix<M, N, Number>(with_singular_values(random, sigma, N).template cast<Number>()), random);
    }
  }

  static constexpr double kEpsilon = static_cast<double>(std::numeric_limits<Number>::epsilon());
};

#ifdef FPBM_FEW_TYPES
using Shapes = ::testing::Types<Shape<2, 4, float>, Shape<6, 7>>;
#else
using Shapes = ::testing::Types<Shape<2, 4, float>, Shape<3, 7>, Shape<6, 7>>;
#endif

struct ShapeNames {
  template <typename Shape>
  static std::string GetName(int) {
    const std::string size = "m" + std::to_string(Shape::M) + "_n" + std::to_string(Shape::N);
    return std::is_same_v<typename Shape::Scalar, float> ? size + "_float" : size;
  }
};
TYPED_TEST_SUITE(Spectra, Shapes, ShapeNames);

/// ‖Jᵀ(JJᵀ + Δ)⁻¹‖ ≤ 1.17/ε for any number of lost directions, and the bound is tight. With weights, ‖W⁻¹Jᵀ(JW⁻¹Jᵀ +
/// Δ)⁻¹‖ ≤ 1.28 √cond(W)/ε.
TYPED_TEST(Spectra, bound_the_damped_inverse) {
  using Fixture = TestFixture;
  using Scalar = typename Fixture::Number;
  const SingularDamping<Scalar> damping(Scalar(0.05));
  const double slack = 1.0 + 1e3 * Fixture::kEpsilon;
  double largest = 0.0;
  Fixture::everywhere(0.1, [&](const auto& J, Random& random) {
    const double edge = 0.05 * static_cast<double>(J.norm());
    const double gain = edge * static_cast<double>(singular_values(damped_inverse(UnitWeights{}, damping, J))(0));
    EXPECT_LE(gain, 1.17 * slack);
    largest = std::max(largest, gain);

    const Vector<Fixture::N, Scalar> w = random.uniform(Fixture::N, 0.5, 8.0).template cast<Scalar>();
    const DiagonalWeights<Fixture::N, Scalar> weights(w);
    const double spread = std::sqrt(static_cast<double>(w.maxCoeff() / w.minCoeff()));
    const RealMatrix weighted = damped_inverse(weights, damping, J);
    EXPECT_LE(edge * static_cast<double>(singular_values(weighted)(0)), 1.28 * spread * slack);
  });
  EXPECT_GT(largest, 1.16);
}

/// Largest errors of secondary motion.
struct FreeErrors {
  double task = 0.0;        ///< |J u|/(‖J‖ |z|)
  double definition = 0.0;  ///< |u − free_motion()|/|z|, in units of ε_machine/radius².
};

/// Adds the errors of the motion u of a scheme without a command, at rest.
template <int M, int N, typename Scalar, typename Scheme>
void add_errors(FreeErrors& errors, const Scheme& scheme, const Matrix<M, N, Scalar>& J, const RealMatrix& W,
                const Vector<N, Scalar>& q) {
  Vector<N, Scalar> u = Vector<N, Scalar>::Zero();
  const Vector<M, Scalar> nothing = Vector<M, Scalar>::Zero();
  const State<N, Scalar> at_rest{q, Vector<N, Scalar>::Zero()};
  const Matrix<M, N, Scalar> Jd = Matrix<M, N, Scalar>::Zero();
  const Status status = scheme.resolve_rows(TaskEquation<M, N, Scalar>{J, Jd, nothing, nothing}, at_rest, u);
  EXPECT_FALSE(failed(status)) << message(status);
  const RealVector z = real(scheme.null_space.template at<fpbm::Level::kVelocity>(at_rest));
  const auto radius = static_cast<double>(scheme.singular.radius());
  const auto size = static_cast<double>(z.norm());
  const RealVector away = real(u) - free_motion(real(J), W, radius, z);
  const auto unit = static_cast<double>(std::numeric_limits<Scalar>::epsilon()) / (radius * radius);
  errors.task = std::max(errors.task, static_cast<double>((real(J) * real(u)).norm() / real(J).norm()) / size);
  errors.definition = std::max(errors.definition, static_cast<double>(away.norm()) / size / unit);
}

/// Secondary motion has no task motion, whether or not directions are lost, and is the exact projection up to round-off
/// errors: rest posture and free choice, at both levels, with and without weights.
TYPED_TEST(Spectra, have_secondary_motion_without_task_motion) {
  using Fixture = TestFixture;
  using Scalar = typename Fixture::Number;
  constexpr int kJoints = Fixture::N;
  FreeErrors errors;
  for (const double wanted : {0.005, 0.02, 0.2}) {
    const double radius = std::max(wanted, 32.0 * std::sqrt(Fixture::kEpsilon));
    Fixture::everywhere(2.0 * radius, [&](const auto& J, Random& random) {
      const auto vector = [&](double low, double high) -> Vector<kJoints, Scalar> {
        return random.uniform(kJoints, low, high).template cast<Scalar>();
      };
      const auto z = NullSpace<kJoints, Scalar>{}
                         .with_damping(Scalar(2))
                         .with_rest_posture(vector(-2.0, 2.0), Scalar(1.5))
                         .with_free_choice(vector(-1.0, 1.0));
      const Vector<kJoints, Scalar> q = vector(-2.0, 2.0);
      const Vector<kJoints, Scalar> W = vector(0.5, 4.0);
      const SingularDamping<Scalar> damping{Scalar(radius)};
      const RealMatrix unit = RealMatrix::Identity(kJoints, kJoints);
      const RealMatrix weights = real(W).asDiagonal();
      add_errors(errors, MVN<kJoints, Scalar>(Scalar(1), z, damping), J, unit, q);
      add_errors(errors, WMVN<kJoints, Scalar>(W, Scalar(1), z, damping), J, weights, q);
      add_errors(errors, MAN<kJoints, Scalar>(z, damping), J, unit, q);
      for (const double alpha : {0.0, 0.6, 1.0}) {
        add_errors(errors, Balanced<kJoints, Scalar>(Scalar(alpha), W, z, damping), J, weights, q);
      }
    });
  }
  EXPECT_LE(errors.task, 256.0 * Fixture::kEpsilon);
  EXPECT_LE(errors.definition, 64.0);
  std::printf("|J u|/(|J| |z|): %.1e, error of the projection: %.1e epsilon/radius^2\n", errors.task,
              errors.definition);
}

/// σ_min/√M ≤ bound ≤ σ_min, and the bound is 0 if a direction is lost.
TYPED_TEST(Spectra, have_a_bound_below_the_least_singular_value) {
  using Fixture = TestFixture;
  int lost = 0;
  Fixture::everywhere(0.1, [&](const auto& J, Random&) {
    const auto bound = static_cast<double>(least_singular_value_bound(J));
    const double sigma = least_singular_value(real(J));
    const double relative = sigma / static_cast<double>(J.norm());
    // The bound is computed from JJᵀ, which has σ² up to round-off error. Therefore σ has the error √epsilon.
    const double round_off = 64.0 * Fixture::kEpsilon / (relative * relative);
    if (relative < 4.0 * Fixture::kEpsilon) {
      EXPECT_LE(bound, 2.0 * std::sqrt(Fixture::kEpsilon) * static_cast<double>(J.norm()));
      ++lost;
    } else if (round_off < 0.1) {
      EXPECT_LE(bound, (1.0 + round_off) * sigma);
      EXPECT_GE(bound, (1.0 - round_off) * sigma / std::sqrt(Fixture::M));
    }
  });
  EXPECT_GT(lost, 0);
}

/// Cholesky::inverse_trace, from which the bound is computed.
TYPED_TEST(Spectra, have_the_trace_of_the_inverse) {
  using Fixture = TestFixture;
  using Gram = Matrix<Fixture::M, Fixture::M, typename Fixture::Number>;
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Gram A = random.positive_definite(Fixture::M).template cast<typename Fixture::Number>();
    Cholesky<Fixture::M, typename Fixture::Number> cholesky;
    if (cholesky.factor(A) != Status::kOk) FAIL();  // With ASSERT_EQ, g++ warns of an uninitialised factor.
    const auto expected = static_cast<double>(inverse(real(A)).trace());
    EXPECT_NEAR(static_cast<double>(cholesky.inverse_trace()), expected, 256.0 * Fixture::kEpsilon * expected);
  }
}

Recording<4> paper_run(Figure figure, const AccelerationScheme<4>& scheme) {
  return recorded(paper_arm(), paper_path(figure), scheme, paper_start(), TimeGrid<>(kDuration, 1e-3));
}

/// The motions of the paper are far from singular: damping changes no bit.
TEST(DampedMotion, leaves_the_bits_of_the_papers_motions_alone) {
  for (const PaperCase& each : kPaperCases) {
    auto scheme = FPBM<4>(each.alpha, Vector<4>(each.weights.data()), each.k1, each.k2);
    const Recording<4> plain = paper_run(each.figure, scheme);
    scheme.singular = SingularDamping<>();
    const Recording<4> run = paper_run(each.figure, scheme);
    ASSERT_EQ(run.result.status, Status::kOk);
    ASSERT_EQ(run.samples.size(), plain.samples.size());
    for (std::size_t i = 0; i < run.samples.size(); ++i) {
      const auto same = [&](const auto& member) {
        return std::memcmp(&(run.samples[i].*member), &(plain.samples[i].*member), sizeof(plain.samples[i].*member)) ==
               0;
      };
      using Sample4 = Sample<Position<2>, 4>;
      ASSERT_TRUE(same(&Sample4::q) && same(&Sample4::qd) && same(&Sample4::qdd) && same(&Sample4::error))
          << each.where << ", sample " << i;
    }
  }
}

/// Calls check(name, scheme) with a scheme of each type.
template <typename Check>
void with_every_scheme(Check&& check) {
  Law law;
  law.alpha = 0.6;
  law.k1 = law.k2 = 1.0;
  law.W = Vector<4>(1, 2, 3, 4).asDiagonal();
  for_every_scheme<4, double, Kinds::kUnitAndDiagonal>(
      [&](const std::string& name, const Takes& takes, const auto& make) {
        law.k = takes.weights ? 5.0 : 0.0;
        check(name, make(law));
      });
}

/// Smallest distance to a singular posture along a motion of the paper's arm.
double nearest_to_singular(const Recording<4>& run) {
  double nearest = 1.0;
  for (const auto& sample : run.samples) {
    Kinematics<Position<2>, 4> kinematics;
    paper_arm().kinematics(sample.q, kinematics);
    nearest = std::min(nearest, static_cast<double>(least_singular_value(real(kinematics.J)) / kinematics.J.norm()));
  }
  return nearest;
}

/// A motion that enters the radius slightly is completed, and its status reports the damping.
TEST(DampedMotion, that_enters_the_radius_a_little_reaches_its_end) {
  with_every_scheme([](const std::string& name, auto scheme) {
    SCOPED_TRACE(name);
    const auto run_with = [&](double radius) {
      scheme.singular = SingularDamping<>(radius);
      return recorded(paper_arm(), paper_circle(), scheme, paper_start(), TimeGrid<>(kDuration, 1e-3));
    };
    const Recording<4> plain = run_with(0.0);
    const double nearest = nearest_to_singular(plain);
    EXPECT_EQ(run_with(0.999 * nearest).result.status, Status::kOk);
    const Recording<4> run = run_with(1.01 * nearest);
    EXPECT_EQ(run.result.status, Status::kDamped);
    EXPECT_EQ(run.samples.size(), plain.samples.size());
    EXPECT_LE(run.max_error(), 1e-4);
  });
}

/// On a circle larger than the workspace, the motion stops where the tip leaves the circle, with any damping.
TEST(DampedMotion, that_leaves_its_path_is_stopped) {
  const AnyPath<Position<2>> path(Path(Circle(4.5), 5.0));
  const double fastest = path.sample(2.5).xd.norm();
  with_every_scheme([&](const std::string& name, auto scheme) {
    for (const double radius : {0.01, 0.05, 0.2}) {
      for (const double dt : {1e-3, 1e-2}) {
        for (std::uint32_t seed = 0; seed < 10; ++seed) {
          SCOPED_TRACE(name + ", radius " + std::to_string(radius) + ", dt " + std::to_string(dt) + ", seed " +
                       std::to_string(seed));
          Random random(seed);
          State<4> start{random.uniform(4, 0.2, 1.0), Vector<4>::Zero()};
          start.q(0) = random.uniform(-kPi, kPi);
          scheme.singular = SingularDamping<>(radius);
          const auto run = recorded(paper_arm(), path, scheme, start, TimeGrid<>(5.0, dt));
          EXPECT_EQ(run.result.status, Status::kTaskLost) << message(run.result.status);
          EXPECT_LE(run.max_error(), 1.1 * fastest * dt);
          for (const auto& sample : run.samples) ASSERT_TRUE(sample.qdd.allFinite() && sample.error.allFinite());
        }
      }
    }
  });
}

/// Largest joint speed [rad/s] after 30 s under FPBM toward a point 0.1 m beyond the workspace, in a loop that does not
/// stop.
double speed_at_the_edge(double brake, std::uint32_t seed) {
  Random random(seed);
  const auto arm = paper_arm();
  const auto scheme = FPBM<4>(0.6, paper_weights(), 4.0, 4.0, {}, SingularDamping<>(0.01, brake));
  ClosedLoop<PlanarArm<4>, AccelerationScheme<4>, Position<2>> loop{arm, scheme, {}, {}, {}};
  Matrix<4, 2> x = Matrix<4, 2>::Zero();
  x.col(0) = random.uniform(4, 0.2, 1.2);
  arm.kinematics(Vector<4>(x.col(0)), loop.kinematics);
  const double direction = random.uniform(-kPi, kPi);
  const Vector<2> displacement = 4.1 * Vector<2>(std::cos(direction), std::sin(direction)) - loop.kinematics.tip;
  const Path<Line<2>> path(Line<2>(displacement), 5.0);
  AnchoredPath<Path<Line<2>>> references(path, loop.kinematics.tip);
  const auto derivative = [&](double t, const Matrix<4, 2>& at, Matrix<4, 2>& rate) noexcept {
    return loop.evaluate(t < 5.0 ? references.motion(t, t) : references.hold(), at, rate);
  };
  for (int i = 0; i < 30000; ++i) {
    if (failed(RK4::step(derivative, 1e-3 * i, 1e-3, x))) return std::numeric_limits<double>::infinity();
  }
  return x.col(1).cwiseAbs().maxCoeff();
}

/// With the brake, an arm with an unreachable target stops at the workspace boundary.
TEST(DampedMotion, stops_at_the_workspace_boundary) {
  double without_brake = 0.0;
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    EXPECT_LT(speed_at_the_edge(100.0, seed), 1e-3) << "seed " << seed;
    without_brake = std::max(without_brake, speed_at_the_edge(0.0, seed));
  }
  EXPECT_GT(without_brake, 1e-2);
}

}  // namespace
}  // namespace fpbm::test::damping_laws
