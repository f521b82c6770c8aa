#include "fpbm/objective/second_task.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/recording.hpp"
#include "support/textbook.hpp"

/// A second task in the null space of the first: an elbow that holds a point, a tip that looks in a direction.
namespace fpbm::test {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using Rows = Vector<2>;

/// The first joints of a chain; its tip is the origin of the last joint's frame.
Chain<> first_joints(Chain<> chain, std::size_t count) {
  chain.joints.resize(count);
  chain.tip = {};
  return chain;
}

/// A usual start posture of the Panda.
Vector<7> panda_ready() {
  return Vector<7>{0.1, -0.5, 0.2, -2.0, 0.1, 1.8, 0.7};
}

AccelerationScheme<7> panda_scheme() {
  return FPBM<7>(0.6, Vector<7>(Vector<7>::Ones()), 10.0, 25.0, NullSpace<7>{}.with_damping(5.0));
}

/// s = 0 where the tip looks in the desired direction, elsewhere |s| = 2 tan(θ/2); J is the derivative of s, and Jd
/// that of J along qd.
TEST(Gaze, is_a_chart_of_directions) {
  const auto check = [](const auto& arm) {
    using Arm = std::decay_t<decltype(arm)>;
    using Joints = Vector<Arm::kDof>;
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      const Joints q = random.uniform(arm.dof(), -1.5, 1.5);
      const Joints qd = random.uniform(arm.dof(), -1.0, 1.0);
      Kinematics<Pose, Arm::kDof> pose;
      arm.kinematics(q, pose);
      const Vector<3> axis = pose.tip.R.col(2);
      Kinematics<Position<2>, Arm::kDof> out;
      Gaze(arm, Vector<3>(7.0 * axis)).kinematics(q, out);
      EXPECT_LE(out.tip.norm(), 1e-15);

      const Vector<3> desired = random.uniform(3, -1.0, 1.0);
      const Gaze gaze(arm, desired);
      EXPECT_LE((gaze.direction() - desired.normalized()).norm(), 1e-15);
      gaze.kinematics(q, qd, out);
      const double angle = std::acos(axis.dot(desired.normalized()));
      EXPECT_NEAR(out.tip.norm(), 2.0 * std::tan(angle / 2.0), 1e-12 * (1.0 + out.tip.squaredNorm()));
      Kinematics<Position<2>, Arm::kDof> ahead;
      Kinematics<Position<2>, Arm::kDof> behind;
      const double tolerance = 1e-7 * std::pow(1.0 + out.tip.norm(), 4);
      for (Eigen::Index k = 0; k < q.size(); ++k) {
        const Joints step = 1e-5 * Joints::Unit(q.size(), k);
        gaze.kinematics(q + step, ahead);
        gaze.kinematics(q - step, behind);
        EXPECT_LE((out.J.col(k) - (ahead.tip - behind.tip) / 2e-5).norm(), tolerance) << "joint " << k;
      }
      gaze.kinematics(q + 1e-5 * qd, ahead);
      gaze.kinematics(q - 1e-5 * qd, behind);
      EXPECT_EQ(ahead.tip.size(), 2);
      EXPECT_LE((out.Jd - (ahead.J - behind.J) / 2e-5).norm(), tolerance);
    }
  };
  check(SerialArm<7>(presets::panda()));
  check(any_arm(panda_on_rail()));
  check(any_arm(coupled_panda()));
}

TEST(Gaze, is_finite_even_in_the_opposite_direction) {
  const SerialArm<7> arm(presets::panda());
  Kinematics<Pose, 7> pose;
  arm.kinematics(panda_ready(), pose);
  Kinematics<Position<2>, 7> out;
  Gaze(arm, Vector<3>(-pose.tip.R.col(2))).kinematics(panda_ready(), panda_ready(), out);
  EXPECT_TRUE(out.tip.allFinite() && out.J.allFinite() && out.Jd.allFinite());
}

TEST(Gaze, refuses_directions_that_point_nowhere) {
  const SerialArm<7> arm(presets::panda());
  EXPECT_NE(complaint([&] { Gaze(arm, Vector<3>(0.0, 0.0, 0.0)); }).find("direction = 0"), std::string::npos);
  EXPECT_NE(complaint([&] { Gaze(arm, Vector<3>(0.0, kPi / 0.0, 0.0)); }).find("direction[1] = inf"),
            std::string::npos);
  EXPECT_EQ(Gaze(arm, Vector<3>(0.0, 1e-300, 0.0)).direction(), Vector<3>::UnitY());
  EXPECT_EQ(Gaze(arm, Vector<3>(0.0, 1e300, 0.0)).direction(), Vector<3>::UnitY());
}

TEST(DampedLeastSquares, is_the_pseudoinverse_where_nothing_is_lost_and_bounded_where_it_is) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    Matrix<3, 5> A = random.uniform(3, 5, -1.0, 1.0);
    const Vector<3> r = random.uniform(3, -1.0, 1.0);
    const RealVector expected = pseudoinverse(real(A)) * real(r);
    EXPECT_LE((real(damped_least_squares(A, r, 1e-8)) - expected).norm(), 1e-10L * (1 + expected.norm()));
    A.row(2) = 2.0 * A.row(0) - A.row(1);
    for (const double off : {0.0, 1e-12, 1e-6, 1e-3, 1e-2, 1e-1}) {
      A(2, 4) += off;
      EXPECT_LE(damped_least_squares(A, r, 0.01).norm(), 1.17 * r.norm() / 0.1) << "off by " << off;
    }
  }
  EXPECT_EQ((damped_least_squares(Matrix<3, 5>(Matrix<3, 5>::Zero()), Vector<3>(1, 2, 3), 0.0)), Vector<5>::Zero());
}

/// The tip is not disturbed, the second task is met where it can be, and the change of u is the least that does it,
/// (J₂N)⁺(b₂ − J₂u₁) with N = I − J⁺J formed. The second task is the tip of an arm of the first joints. Returns in how
/// many of ten states it could be met.
template <typename First, typename Second, typename Scheme, typename Arm, typename Elbow>
int expect_strict_priority(const Scheme& scheme, const Arm& arm, const Elbow& elbow) {
  constexpr int N = Arm::kDof;
  int met = 0;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const State<N> state{random.uniform(arm.dof(), -1.5, 1.5), random.uniform(arm.dof(), -1.0, 1.0)};
    Kinematics<First, N> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    const auto reference = random_reference(random, kinematics);
    const State<Elbow::kDof> seen{state.q.head(elbow.dof()), state.qd.head(elbow.dof())};
    Kinematics<Second, Elbow::kDof> at;
    elbow.kinematics(seen.q, seen.qd, at);
    const auto desired = random_reference(random, at);
    const SecondTask both(scheme, elbow, desired, 3.0, 2.0);
    both.require_dof(arm.dof());
    Vector<N> own = state.q;
    Vector<N> u = state.q;
    EXPECT_EQ(scheme.resolve(kinematics, reference, state, own), Status::kOk);
    EXPECT_EQ(both.resolve(kinematics, reference, state, u), Status::kOk);

    const RealMatrix J = real(kinematics.J);
    const RealVector change = real(u) - real(own);
    EXPECT_LE((J * change).norm(), 1e-10L);
    RealMatrix J2 = RealMatrix::Zero(Second::kRows, arm.dof());
    J2.leftCols(elbow.dof()) = real(at.J);
    const RealVector rate = J2 * real(state.qd);
    RealVector b = real(desired.xd) + 2 * (real(desired.x) - real(at.tip));
    if (Scheme::kLevel == Level::kAcceleration) {
      b = real(desired.xdd) - real(at.Jd) * real(seen.qd) + 3 * (real(desired.xd) - rate) +
          2 * (real(desired.x) - real(at.tip));
    }
    const RealMatrix A = J2 * (RealMatrix::Identity(arm.dof(), arm.dof()) - pseudoinverse(J) * J);
    if (singular_values(A)(b.size() - 1) < static_cast<Real>(both.radius) * J2.norm()) continue;
    ++met;
    EXPECT_LE((J2 * real(u) - b).norm(), 1e-10L);
    EXPECT_LE((change - pseudoinverse(A) * (b - J2 * real(own))).norm(), 1e-9L);
  }
  return met;
}

TEST(SecondTask, comes_strictly_second) {
  const auto at_both_levels = [&](auto first, auto second, const auto& arm, const auto& elbow) {
    using First = decltype(first);
    using Second = decltype(second);
    constexpr int N = std::decay_t<decltype(arm)>::kDof;
    const Vector<N> W = Vector<N>::LinSpaced(arm.dof(), 1.0, 2.0);
    const auto z = NullSpace<N>{}.with_damping(2.0);
    return expect_strict_priority<First, Second>(WMVN<N>(W, 1.0), arm, elbow) +
           expect_strict_priority<First, Second>(FPBM<N>(0.6, W, 1.0, 1.0, z), arm, elbow);
  };
  const Position<2> flat;
  const Position<3> spatial;
  const PlanarArm<2> planar_elbow(Vector<2>(1.0, 0.8));
  const AnyArm<Position<2>> any_planar_elbow(planar_elbow);
  const AnyArm<Position<3>> elbow = any_arm(first_joints(panda_on_rail(), 5));
  int met = at_both_levels(flat, flat, OwnArm{}, planar_elbow);
  for (const Vector<kOpen>& lengths :
       {Vector<kOpen>(Vector<4>(1.0, 0.8, 0.6, 0.4)), Vector<kOpen>(Vector<6>::Ones())}) {
    met += at_both_levels(flat, flat, any_planar_arm(lengths), any_planar_elbow);
  }
  met += at_both_levels(spatial, spatial, any_arm(panda_on_rail()), elbow);
  met += at_both_levels(spatial, spatial, any_arm(coupled_panda()), elbow);
  EXPECT_GE(met, 60) << "of 100";
  // The second task has more rows than the first leaves joints for: it is met as well as can be, and the tip is still
  // not disturbed.
  const AnyArm<Position<3>> panda_elbow = any_arm(first_joints(presets::panda(), 4));
  EXPECT_EQ(at_both_levels(Pose{}, spatial, any_arm(presets::panda()), panda_elbow), 0);
  EXPECT_EQ(at_both_levels(PlanarPose{}, flat, any_planar_arm(Vector<4>::Ones()), any_planar_elbow), 0);
  EXPECT_EQ(at_both_levels(flat, flat, any_planar_arm(Vector<2>(1.0, 0.8)), any_planar_elbow), 0);
}

/// The first task again as the second, with another target: it cannot be met, and u does not change.
TEST(SecondTask, that_contradicts_the_first_is_dropped) {
  const PlanarArm<4> arm(Vector<4>(1.0, 0.8, 0.6, 0.4));
  const State<4> state{Vector<4>(0.3, 0.5, -0.8, 1.0), Vector<4>(0.1, 0.2, 0.3, 0.4)};
  Kinematics<Position<2>, 4> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  const auto reference = Reference<Position<2>>::hold(kinematics.tip);
  const auto elsewhere = Reference<Position<2>>::hold(Rows(-1.0, 1.0));
  Vector<4> own;
  Vector<4> u;
  ASSERT_EQ(paper_fpbm().resolve(kinematics, reference, state, own), Status::kOk);
  ASSERT_EQ(SecondTask(paper_fpbm(), arm, elsewhere, 1.0, 1.0).resolve(kinematics, reference, state, u), Status::kOk);
  EXPECT_LE((u - own).norm(), 1e-9);
}

TEST(SecondTask, refuses_what_makes_no_sense) {
  const PlanarArm<kOpen> elbow(Vector<3>::Ones());
  const auto here = Reference<Position<2>>::hold(Rows::Zero());
  const auto scheme = MVN<kOpen>();
  EXPECT_NE(complaint([&] { SecondTask(scheme, elbow, here, -1.0, 1.0); }).find("second_task.k1 = -1"),
            std::string::npos);
  EXPECT_NE(complaint([&] { SecondTask(scheme, elbow, here, 1.0, kPi / 0.0); }).find("second_task.k2 = inf"),
            std::string::npos);
  for (const double radius : {0.0, -0.1, 1.1}) {
    EXPECT_NE(complaint([&] { SecondTask(scheme, elbow, here, 1.0, 1.0, radius); }).find("second_task.radius = "),
              std::string::npos);
  }
  EXPECT_NE(complaint([&] { SecondTask(scheme, elbow, here, 1.0, 1.0).require_dof(2); }).find("arm.dof = 3"),
            std::string::npos);
  EXPECT_EQ(complaint([&] { SecondTask(scheme, elbow, here, 1.0, 1.0).require_dof(3); }), "");
}

/// Where the first task or the second fails, resolve() fails and leaves u alone.
TEST(SecondTask, hands_failures_on) {
  const PlanarArm<4> arm = paper_arm();
  const PlanarArm<2> elbow(Vector<2>::Ones());
  const auto attempt = [&](const Vector<4>& q, const Rows& x) {
    const State<4> state{q, Vector<4>::Zero()};
    Kinematics<Position<2>, 4> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    Vector<4> u = Vector<4>::Constant(42.0);
    const Status status = SecondTask(paper_fpbm(), elbow, Reference<Position<2>>::hold(x), 1.0, 1.0)
                              .resolve(kinematics, Reference<Position<2>>::hold(kinematics.tip), state, u);
    EXPECT_EQ(failed(status), u == Vector<4>::Constant(42.0));
    return status;
  };
  EXPECT_EQ(attempt(paper_start().q, Rows(1.0, 1.0)), Status::kOk);
  EXPECT_EQ(attempt(Vector<4>::Zero(), Rows(1.0, 1.0)), Status::kSingular);
  EXPECT_EQ(attempt(paper_start().q, Rows(1.0, kPi / 0.0)), Status::kNotFinite);
}

/// While the tip goes round a circle, the elbow holds its point.
TEST(SecondTask, is_held_all_the_way_round) {
  const PlanarArm<4> arm = paper_arm();
  const PlanarArm<2> elbow(Vector<2>::Ones());
  const State<4> start{Vector<4>(0.3, 0.6, 0.9, -0.9), Vector<4>::Zero()};
  Kinematics<Position<2>, 2> at;
  elbow.kinematics(start.q.head<2>(), at);
  const AnyPath<Position<2>> circle(Path(Circle(0.15), kDuration));
  const Rows where = at.tip;
  const auto elbow_error = [&](const auto& scheme) {
    const auto run = recorded(arm, circle, scheme, start, TimeGrid<>(kDuration, 1e-2, 1.0));
    EXPECT_EQ(run.result.status, Status::kOk);
    EXPECT_LE(run.max_error(), 1e-9);
    double largest = 0.0;
    for (const auto& sample : run.samples) {
      elbow.kinematics(sample.q.template head<2>(), at);
      largest = std::max(largest, (at.tip - where).norm());
    }
    return largest;
  };
  const auto hold = Reference<Position<2>>::hold(where);
  EXPECT_LE(elbow_error(SecondTask(paper_fpbm(), elbow, hold, 4.0, 4.0)), 1e-9);
  EXPECT_GT(elbow_error(paper_fpbm()), 1e-2);
  EXPECT_LE(elbow_error(SecondTask(MVN<4>(1.0), elbow, hold, 0.0, 4.0)), 1e-9);
  EXPECT_GT(elbow_error(MVN<4>(1.0)), 1e-2);
}

/// A wrist that starts 20 degrees off turns to the desired direction, while the tip goes round a circle.
TEST(SecondTask, turns_the_gaze) {
  const SerialArm<7> arm(presets::panda());
  const State<7> start{panda_ready(), Vector<7>::Zero()};
  Kinematics<Pose, 7> pose;
  arm.kinematics(start.q, pose);
  const Vector<3> axis = pose.tip.R.col(2);
  const Vector<3> desired = rotation(Vector<3>(0.25, 0.25, 0.0)).lazyProduct(axis);
  const Gaze gaze(arm, desired);
  const SecondTask scheme(panda_scheme(), gaze, Reference<Position<2>>::hold(Rows::Zero()), 6.0, 9.0);
  const InPlane circle(Path(Circle(0.05), 5.0), Vector<3>::UnitY(), Vector<3>::UnitZ());
  double error = 0.0;
  const auto result = rollout(arm, circle, scheme, start, TimeGrid<>(5.0, 1e-2),
                              [&](const auto& sample) { error = std::max(error, sample.error.norm()); });
  ASSERT_EQ(result.status, Status::kOk);
  EXPECT_LE(error, 1e-8);
  arm.kinematics(result.last.q, pose);
  EXPECT_LE((pose.tip.R.col(2) - gaze.direction()).norm(), 1e-4);
  EXPECT_GT((axis - gaze.direction()).norm(), 0.2);
}

/// An elbow whose target is far out of reach comes smoothly to rest as near as it can, and the tip keeps its path.
TEST(SecondTask, out_of_reach_comes_to_rest) {
  const PlanarArm<4> arm = paper_arm();
  const PlanarArm<2> elbow(Vector<2>::Ones());
  const State<4> start{Vector<4>(0.3, 0.6, 0.9, -0.9), Vector<4>::Zero()};
  const AnyPath<Position<2>> circle(Path(Circle(0.01), 1.0));
  const auto far = Reference<Position<2>>::hold(Rows(0.0, 3.0));
  const auto damped = paper_fpbm(NullSpace<4>{}.with_damping(5.0));
  const auto run = recorded(arm, circle, SecondTask(damped, elbow, far, 4.0, 1.0), start, TimeGrid<>(1.0, 1e-3, 20.0));
  ASSERT_EQ(run.result.status, Status::kOk);
  EXPECT_LE(run.max_error(), 1e-8);
  EXPECT_LE(run.result.last.qd.norm(), 1e-3);
  for (const auto& sample : run.samples) ASSERT_LE(sample.qd.norm(), 5.0) << "at t = " << sample.t;
}

/// The caller may change the reference between calls.
TEST(SecondTask, follows_a_reference_that_is_replaced) {
  const PlanarArm<4> arm = paper_arm();
  const PlanarArm<2> elbow(Vector<2>::Ones());
  State<4> state{Vector<4>(0.3, 0.6, 0.9, -0.9), Vector<4>::Zero()};
  Kinematics<Position<2>, 4> kinematics;
  Kinematics<Position<2>, 2> at;
  arm.kinematics(state.q, kinematics);
  const auto hold = Reference<Position<2>>::hold(kinematics.tip);
  elbow.kinematics(state.q.head<2>(), at);
  const Rows middle = at.tip;
  SecondTask scheme(MVN<4>(5.0), elbow, Reference<Position<2>>::hold(middle), 0.0, 5.0);
  for (int i = 0; i < 1000; ++i) {
    const double t = 1e-3 * i;
    scheme.reference.x = middle + 0.1 * Rows(std::sin(t), std::cos(t) - 1.0);
    scheme.reference.xd = 0.1 * Rows(std::cos(t), -std::sin(t));
    arm.kinematics(state.q, kinematics);
    ASSERT_EQ(scheme.resolve(kinematics, hold, state, state.qd), Status::kOk);
    state.q += 1e-3 * state.qd;
  }
  elbow.kinematics(state.q.head<2>(), at);
  arm.kinematics(state.q, kinematics);
  EXPECT_LE((at.tip - scheme.reference.x).norm(), 2e-4);
  EXPECT_GT((at.tip - middle).norm(), 0.05);
  EXPECT_LE((kinematics.tip - hold.x).norm(), 1e-4);
}

/// Wrapped round an ascent, the second task is met, and the ascent has the joints that are left.
TEST(SecondTask, goes_before_what_it_wraps) {
  const PlanarArm<kOpen> arm(Vector<6>::Ones());
  const PlanarArm<2> elbow(Vector<2>::Ones());
  const State<kOpen> state{Vector<6>(0.3, 0.6, 0.9, -0.9, 0.4, 0.2), Vector<6>::Constant(0.1)};
  Kinematics<Position<2>, kOpen> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  Kinematics<Position<2>, 2> at;
  elbow.kinematics(state.q.head<2>(), at);
  const auto reference = Reference<Position<2>>::hold(kinematics.tip);
  const auto point = Reference<Position<2>>::hold(at.tip + Rows(0.1, 0.2));
  const auto bare = MVN<kOpen>(1.0);
  const ManipulabilityAscent ascent(bare, arm, 1.0);
  Vector<kOpen> without;
  Vector<kOpen> with;
  Vector<kOpen> after;
  ASSERT_EQ(SecondTask(bare, elbow, point, 0.0, 2.0).resolve(kinematics, reference, state, without), Status::kOk);
  ASSERT_EQ(SecondTask(ascent, elbow, point, 0.0, 2.0).resolve(kinematics, reference, state, with), Status::kOk);
  ASSERT_EQ(ManipulabilityAscent(SecondTask(bare, elbow, point, 0.0, 2.0), arm, 1.0)
                .resolve(kinematics, reference, state, after),
            Status::kOk);
  EXPECT_LE((at.J * with.head<2>() - 2.0 * Rows(0.1, 0.2)).norm(), 1e-12);
  EXPECT_LE((at.J * without.head<2>() - 2.0 * Rows(0.1, 0.2)).norm(), 1e-12);
  EXPECT_GT((at.J * after.head<2>() - 2.0 * Rows(0.1, 0.2)).norm(), 1e-3);
  EXPECT_GT(manipulability_gradient<Position<2>>(arm, state.q).dot(with - without), 1e-3);
  EXPECT_LE((kinematics.J * (after - with)).norm(), 1e-12);
}

}  // namespace
}  // namespace fpbm::test
