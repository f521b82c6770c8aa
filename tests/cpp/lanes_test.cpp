#include "fpbm/core/lanes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "fpbm/fpbm.hpp"
#include "support/random.hpp"

/// Each lane computes the same motion as a single motion, for all contents of the other lanes.
namespace fpbm::test::lanes_laws {
namespace {

constexpr int kLanes = 2;
using In = Lanes<kLanes>;
using Masks = Mask<In>;

static_assert(kInLanes<In> && !kInLanes<double> && !kInLanes<Pair<double>>);
static_assert(std::is_same_v<Number<In>, double> && std::is_same_v<Number<float>, float>);

template <int Rows, int Cols>
void set_lane(Matrix<Rows, Cols, In>& all, std::size_t lane, const Matrix<Rows, Cols>& one) {
  for (Eigen::Index i = 0; i < one.size(); ++i) all(i)[lane] = one(i);
}
void set_lane(Transform<In>& all, std::size_t lane, const Transform<>& one) {
  set_lane<3, 1>(all.p, lane, one.p);
  set_lane<3, 3>(all.R, lane, one.R);
}
template <int Rows, int Cols>
Matrix<Rows, Cols> lane_of(const Matrix<Rows, Cols, In>& all, std::size_t lane) {
  return all.unaryExpr([lane](const In& x) -> double { return x[lane]; });
}

TEST(Lanes, have_the_sines_and_cosines_of_each) {
  Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const double reach = std::pow(10.0, random.uniform(-3.0, 5.6));
    const In angles([&](auto) { return random.uniform(-reach, reach); });
    const SinCos<In> both = sincos(angles);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const SinCos<double> alone = sincos(angles[lane]);
      EXPECT_NEAR(both.sin[lane], alone.sin, 3e-16) << angles[lane];
      EXPECT_NEAR(both.cos[lane], alone.cos, 3e-16) << angles[lane];
    }
  }
  const In beyond([](auto lane) { return lane == 1 ? 1e6 : 1.0; });
  EXPECT_TRUE(std::isnan(sincos(beyond).sin[1]) && std::isnan(sincos(beyond).cos[1]));
  EXPECT_NEAR(sincos(beyond).sin[0], std::sin(1.0), 3e-16);
}

TEST(Lanes, have_the_rotation_vector_of_each) {
  Random random(2);
  for (int trial = 0; trial < 500; ++trial) {
    Matrix<3, 3, In> all;
    std::array<Vector<3>, kLanes> each;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      each[lane] = random.uniform(3, -1.0, 1.0) * std::pow(10.0, random.uniform(-6.0, 0.2));
      set_lane<3, 3>(all, lane, rotation(each[lane]));
    }
    const Vector<3, In> turns = rotation_vector<In>(all);
    Matrix<3, 3, In> other;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      set_lane<3, 3>(other, lane, rotation(Vector<3>(random.uniform(3, -1.5, 1.5))));
    }
    const Vector<3, In> between = rotation_between<In>(all.lazyProduct(other), other);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      EXPECT_LE((lane_of<3, 1>(turns, lane) - each[lane]).norm(), 1e-15 + 4e-16 / (3.2 - each[lane].norm()));
      EXPECT_LE((lane_of<3, 1>(between, lane) - each[lane]).norm(), 2e-15 + 2e-15 / (3.2 - each[lane].norm()));
    }
  }
}

/// A scheme in lanes with different parameters, and the scheme of each lane.
template <int N>
struct Schemes {
  Vector<N, In> weights;
  In alpha;
  In k1;
  In k2;
  In damping;

  explicit Schemes(Random& random) {
    const auto draw = [&](double low, double high) { return In([&](auto) { return random.uniform(low, high); }); };
    for (int i = 0; i < N; ++i) weights(i) = draw(0.5, 4.0);
    alpha = draw(0.0, 1.0);
    k1 = draw(0.0, 20.0);
    k2 = draw(0.0, 100.0);
    damping = draw(0.0, 3.0);
  }

  template <typename Scalar, typename Part>
  AccelerationScheme<N, Scalar> fpbm(const Part& part, const SingularDamping<Scalar>& singular) const {
    Vector<N, Scalar> w;
    for (int i = 0; i < N; ++i) w(i) = part(weights(i));
    return FPBM<N, Scalar>(part(alpha), w, part(k1), part(k2), NullSpace<N, Scalar>().with_damping(part(damping)),
                           singular);
  }
  template <typename Scalar, typename Part>
  VelocityScheme<N, Scalar> wmvn(const Part& part, const SingularDamping<Scalar>& singular) const {
    Vector<N, Scalar> w;
    for (int i = 0; i < N; ++i) w(i) = part(weights(i));
    return WMVN<N, Scalar>(
        w, part(k1), NullSpace<N, Scalar>().with_rest_posture(Vector<N, Scalar>::Ones(), part(In(0.5))), singular);
  }
};

In whole(const In& x) {
  return x;
}

/// Evaluates a scheme on kLanes arms together, and on each arm alone.
template <typename Space, typename Arm>
void expect_each_to_be_resolved(const Arm& arm, double radius) {
  constexpr int N = Arm::kDof;
  Random random(3);
  int regular = 0;
  int left = 0;
  const auto arms = arm.template cast<In>();
  for (int trial = 0; trial < trials(300); ++trial) {
    State<N, In> states;
    Reference<Space, In> references;
    std::array<State<N>, kLanes> state;
    std::array<Reference<Space>, kLanes> reference;
    Kinematics<Space, N> one;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      state[lane] = {random.uniform(N, 0.2, 1.4), random.uniform(N, -1.0, 1.0)};
      arm.kinematics(state[lane].q, one);
      reference[lane] = {Space::template displace<double>(one.tip, random.uniform(Space::kRows, -0.1, 0.1)),
                         random.uniform(Space::kRows, -1.0, 1.0), random.uniform(Space::kRows, -1.0, 1.0)};
      set_lane<N, 1>(states.q, lane, state[lane].q);
      set_lane<N, 1>(states.qd, lane, state[lane].qd);
      set_lane(references.x, lane, reference[lane].x);
      set_lane<Space::kRows, 1>(references.xd, lane, reference[lane].xd);
      set_lane<Space::kRows, 1>(references.xdd, lane, reference[lane].xdd);
    }
    Kinematics<Space, N, In> all;
    arms.kinematics(states.q, states.qd, all);
    const Schemes<N> schemes(random);
    const SingularDamping<In> damping(In(radius), In(1.0));
    Vector<N, In> qdd;
    Vector<N, In> qd;
    ASSERT_EQ(schemes.template fpbm<In>(whole, damping).resolve(all, references, states, qdd), Status::kOk);
    ASSERT_EQ(schemes.template wmvn<In>(whole, damping).resolve(all, references, states, qd), Status::kOk);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto part = [lane](const In& x) -> double { return x[lane]; };
      const SingularDamping<> damped(radius, 1.0);
      arm.kinematics(state[lane].q, state[lane].qd, one);
      EXPECT_LE((lane_of<Space::kRows, N>(all.J, lane) - one.J).norm(), 1e-14);
      EXPECT_LE((lane_of<Space::kRows, N>(all.Jd, lane) - one.Jd).norm(), 1e-13);
      const double condition = one.J.norm() / least_singular_value_bound(one.J);
      const auto expect_agreement = [&](const auto& scheme, const Vector<N>& answer) {
        Vector<N> expected;
        const Status status = scheme.resolve(one, reference[lane], state[lane], expected);
        if (status == Status::kOk && (radius == 0.0 || !answer.hasNaN())) {
          ++regular;
          EXPECT_LE((answer - expected).norm(), 1e-15 * condition * condition * expected.norm());
        } else {  // In lanes, the result is NaN if damping cannot be excluded.
          ++left;
          EXPECT_TRUE(answer.hasNaN()) << message(status);
        }
      };
      expect_agreement(schemes.template fpbm<double>(part, damped), lane_of<N, 1>(qdd, lane));
      expect_agreement(schemes.template wmvn<double>(part, damped), lane_of<N, 1>(qd, lane));
    }
  }
  EXPECT_GT(regular, trials(300) / 2);
  EXPECT_EQ(left > 0, radius > 0.0);
}

TEST(Lanes, resolve_like_single_arms) {
  expect_each_to_be_resolved<Position<2>>(PlanarArm<4>(Vector<4>(1.0, 0.8, 0.6, 0.4)), 0.0);
  expect_each_to_be_resolved<Pose>(SerialArm<7>(presets::panda()), 0.0);
}

TEST(Lanes, resolve_nearly_singular_postures_like_single_arms) {
  expect_each_to_be_resolved<Position<2>>(PlanarArm<4>(Vector<4>(1.0, 0.8, 0.6, 0.4)), 0.2);
}

/// Last posture and summary of motions from several starts, in lanes.
struct Motions {
  Vector<4, In> q;
  MotionSummary<In> summary;
};
Motions run(const std::array<Vector<4>, kLanes>& starts, double radius) {
  const auto arm = PlanarArm<4>(Vector<4>::Ones()).cast<In>();
  const Path path(Circle<>(radius), 2.0);
  const auto scheme = FPBM<4, In>(In(0.6), DiagonalWeights<4, In>(Vector<4, In>::Ones()), In(10.0), In(25.0));
  State<4, In> start{Vector<4, In>::Zero(), Vector<4, In>::Zero()};
  for (std::size_t lane = 0; lane < kLanes; ++lane) set_lane<4, 1>(start.q, lane, starts[lane]);
  Summary<Position<2>, 4, In> summary(Level::kAcceleration);
  const auto result = rollout(arm, path, scheme, start, TimeGrid<double>(2.0, 0.01, 0.5), summary);
  return {result.last.q, summary.result()};
}

TEST(Lanes, run_like_single_motions) {
  const Vector<4> bent(0.3, 0.8, 0.6, 0.5);
  const Vector<4> other(0.1, 1.2, -0.7, 0.9);
  const Vector<4> outstretched(0.4, 0.01, -0.01, 0.02);  // A point half a metre further is unreachable.

  const PlanarArm<4> arm(Vector<4>::Ones());
  const auto scheme = FPBM<4>(0.6, DiagonalWeights<4>(Vector<4>::Ones()), 10.0, 25.0);
  const Path path(Circle<>(0.25), 2.0);
  const auto alone = [&](const Vector<4>& q) {
    return rollout(arm, path, scheme, {q, Vector<4>::Zero()}, TimeGrid<double>(2.0, 0.01, 0.5), [](const auto&) {});
  };
  ASSERT_TRUE(failed(alone(outstretched).status));

  const Motions healthy = run({bent, other}, 0.25);
  for (const Vector<4>& q : {bent, other}) ASSERT_EQ(alone(q).status, Status::kOk);
  EXPECT_LE((lane_of<4, 1>(healthy.q, 0) - alone(bent).last.q).norm(), 1e-12);
  EXPECT_LE((lane_of<4, 1>(healthy.q, 1) - alone(other).last.q).norm(), 1e-12);

  // Bitwise, in any lane, for all contents of the other lanes.
  const Motions left = run({bent, outstretched}, 0.25);
  const Motions right = run({outstretched, bent}, 0.25);
  EXPECT_EQ((lane_of<4, 1>(left.q, 0)), (lane_of<4, 1>(healthy.q, 0)));
  EXPECT_EQ((lane_of<4, 1>(right.q, 1)), (lane_of<4, 1>(healthy.q, 0)));
  EXPECT_EQ(left.summary.max_error[0], healthy.summary.max_error[0]);
  EXPECT_EQ(right.summary.manipulability[1], healthy.summary.manipulability[0]);
  EXPECT_TRUE(std::isnan(lane_of<4, 1>(left.q, 1).sum()));
  EXPECT_TRUE(std::isnan(lane_of<4, 1>(right.q, 0).sum()));
}

TEST(Lanes, check_the_arguments_of_every_lane) {
  const In alphas([](auto lane) { return lane == 1 ? 1.5 : 0.5; });
  const DiagonalWeights<4, In> weights(Vector<4, In>::Ones());
  EXPECT_THROW((void)(FPBM<4, In>(alphas, weights, In(0.0), In(0.0))), std::invalid_argument);
  Vector<4, In> negative = Vector<4, In>::Ones();
  negative(3)[1] = -1.0;
  EXPECT_THROW((DiagonalWeights<4, In>(negative)), std::invalid_argument);
}

}  // namespace
}  // namespace fpbm::test::lanes_laws
