#include "fpbm/objective/second_task.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/recording.hpp"
#include "support/textbook.hpp"

/// A second task in the null space of the first: an elbow that holds a point, a tip that looks in a direction.
namespace fpbm::test::second_task_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using Rows = Vector<2>;
using Joints = Vector<kOpen>;

/// Arms and schemes of run-time size: each kind of second task compiles once at each level.
AnyArm<Position<2>> planar_arm() {
  return any_planar_arm(Joints::Ones(4));
}
AnyArm<Position<2>> planar_elbow() {
  return any_planar_arm(Joints::Ones(2));
}
AccelerationScheme<kOpen> planar_scheme(const NullSpace<kOpen>& z = {}) {
  return FPBM<kOpen>(0.6, Joints(Vector<4>(1.0, 2.0, 3.0, 4.0)), 1.0, 1.0, z);
}
State<kOpen> planar_start() {
  return {Vector<4>(0.3, 0.6, 0.9, -0.9), Vector<4>::Zero()};
}
Rows tip_of(const AnyArm<Position<2>>& arm, const Joints& q) {
  Kinematics<Position<2>, kOpen> kinematics;
  arm.kinematics(q, kinematics);
  return kinematics.tip;
}

/// The first joints of a chain; its tip is the origin of the last joint's frame.
Chain<> first_joints(Chain<> chain, std::size_t count) {
  chain.joints.resize(count);
  chain.tip = {};
  return chain;
}

/// A usual start posture of the Panda.
Joints panda_ready() {
  return Vector<7>{0.1, -0.5, 0.2, -2.0, 0.1, 1.8, 0.7};
}

AccelerationScheme<kOpen> panda_scheme() {
  return FPBM<kOpen>(0.6, Joints(Joints::Ones(7)), 10.0, 25.0, NullSpace<kOpen>{}.with_damping(5.0));
}

/// s = 0 where the tip looks in the desired direction, elsewhere |s| = 2 tan(θ/2); J is the derivative of s, and Jd
/// that of J along qd.
TEST(Gaze, is_a_chart_of_directions) {
  for (const Chain<>& chain : {presets::panda(), panda_on_rail(), coupled_panda()}) {
    const AnyArm<Position<3>> arm = any_arm(chain);
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      const Joints q = random.uniform(arm.dof(), -1.5, 1.5);
      const Joints qd = random.uniform(arm.dof(), -1.0, 1.0);
      Kinematics<Pose, kOpen> pose;
      arm.kinematics(q, pose);
      const Vector<3> axis = pose.tip.R.col(2);
      Kinematics<Position<2>, kOpen> out;
      Gaze(arm, Vector<3>(7.0 * axis)).kinematics(q, out);
      EXPECT_LE(out.tip.norm(), 1e-15);

      const Vector<3> desired = random.uniform(3, -1.0, 1.0);
      const Gaze gaze(arm, desired);
      EXPECT_LE((gaze.direction() - desired.normalized()).norm(), 1e-15);
      gaze.kinematics(q, qd, out);
      const double angle = std::acos(axis.dot(desired.normalized()));
      EXPECT_NEAR(out.tip.norm(), 2.0 * std::tan(angle / 2.0), 1e-12 * (1.0 + out.tip.squaredNorm()));
      Kinematics<Position<2>, kOpen> ahead;
      Kinematics<Position<2>, kOpen> behind;
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
  }
}

TEST(Gaze, is_finite_even_in_the_opposite_direction) {
  const AnyArm<Position<3>> arm = any_arm(presets::panda());
  Kinematics<Pose, kOpen> pose;
  arm.kinematics(panda_ready(), pose);
  Kinematics<Position<2>, kOpen> out;
  Gaze(arm, Vector<3>(-pose.tip.R.col(2))).kinematics(panda_ready(), panda_ready(), out);
  EXPECT_TRUE(out.tip.allFinite() && out.J.allFinite() && out.Jd.allFinite());
}

TEST(Gaze, refuses_directions_that_point_nowhere) {
  const AnyArm<Position<3>> arm = any_arm(presets::panda());
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

/// A state of an arm with a second task, and the answers of a scheme without the task and with it.
struct Answers {
  RealMatrix J;
  RealMatrix J2;  ///< Of the second task, with a column for each joint of the arm.
  RealVector b;   ///< The second task's command, less Jd₂qd.
  RealVector own;
  RealVector u;
};

/// The tip is not disturbed, the second task is met where it can be, and the change of u is the least that does it,
/// (J₂N)⁺(b₂ − J₂u₁) with N = I − J⁺J formed. Returns whether the task could be met.
bool expect_strict_priority(const Answers& answers, double radius) {
  const auto& [J, J2, b, own, u] = answers;
  const RealVector change = u - own;
  EXPECT_LE((J * change).norm(), 1e-10L);
  const RealMatrix A = J2 * (RealMatrix::Identity(J.cols(), J.cols()) - pseudoinverse(J) * J);
  if (singular_values(A)(b.size() - 1) < static_cast<Real>(radius) * J2.norm()) return false;
  EXPECT_LE((J2 * u - b).norm(), 1e-10L);
  EXPECT_LE((change - pseudoinverse(A) * (b - J2 * own)).norm(), 1e-9L);
  return true;
}

/// The second task is the tip of an arm of the first joints. Returns in how many of ten states it could be met.
template <typename First, typename Second, typename Scheme, typename Arm, typename Elbow>
int expect_strict_priority(const Scheme& scheme, const Arm& arm, const Elbow& elbow) {
  int met = 0;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const State<kOpen> state{random.uniform(arm.dof(), -1.5, 1.5), random.uniform(arm.dof(), -1.0, 1.0)};
    Kinematics<First, kOpen> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    const auto reference = random_reference(random, kinematics);
    const State<kOpen> seen{state.q.head(elbow.dof()), state.qd.head(elbow.dof())};
    Kinematics<Second, kOpen> at;
    elbow.kinematics(seen.q, seen.qd, at);
    const auto desired = random_reference(random, at);
    const SecondTask both(scheme, elbow, desired, 3.0, 2.0);
    both.require_dof(arm.dof());
    Joints own = state.q;
    Joints u = state.q;
    EXPECT_EQ(scheme.resolve(kinematics, reference, state, own), Status::kOk);
    EXPECT_EQ(both.resolve(kinematics, reference, state, u), Status::kOk);

    RealMatrix J2 = RealMatrix::Zero(Second::kRows, arm.dof());
    J2.leftCols(elbow.dof()) = real(at.J);
    const RealVector error = real(desired.x) - real(at.tip);
    RealVector b = real(desired.xd) + 2 * error;
    if (Scheme::kLevel == Level::kAcceleration) {
      b = real(desired.xdd) - real(at.Jd) * real(seen.qd) + 3 * (real(desired.xd) - J2 * real(state.qd)) + 2 * error;
    }
    met += expect_strict_priority({real(kinematics.J), J2, b, real(own), real(u)}, both.radius) ? 1 : 0;
  }
  return met;
}

TEST(SecondTask, comes_strictly_second) {
  const auto at_both_levels = [&](auto first, auto second, const auto& arm, const auto& elbow) {
    using First = decltype(first);
    using Second = decltype(second);
    const Joints W = Joints::LinSpaced(arm.dof(), 1.0, 2.0);
    const auto z = NullSpace<kOpen>{}.with_damping(2.0);
    return expect_strict_priority<First, Second>(WMVN<kOpen>(W, 1.0), arm, elbow) +
           expect_strict_priority<First, Second>(FPBM<kOpen>(0.6, W, 1.0, 1.0, z), arm, elbow);
  };
  const Position<2> flat;
  const Position<3> spatial;
  const AnyArm<Position<2>> flat_elbow = any_planar_arm(Vector<2>(1.0, 0.8));
  const AnyArm<Position<3>> elbow = any_arm(first_joints(panda_on_rail(), 5));
  int met = 0;
  for (const Joints& lengths :
       {Joints(Vector<4>::Ones()), Joints(Vector<4>(1.0, 0.8, 0.6, 0.4)), Joints(Vector<6>::Ones())}) {
    met += at_both_levels(flat, flat, any_planar_arm(lengths), flat_elbow);
  }
  met += at_both_levels(spatial, spatial, any_arm(panda_on_rail()), elbow);
  met += at_both_levels(spatial, spatial, any_arm(coupled_panda()), elbow);
  EXPECT_GE(met, 60) << "of 100";
  // The second task has more rows than the first leaves joints for: it is met as well as can be, and the tip is still
  // not disturbed.
  const AnyArm<Position<3>> panda_elbow = any_arm(first_joints(presets::panda(), 4));
  EXPECT_EQ(at_both_levels(Pose{}, spatial, any_arm(presets::panda()), panda_elbow), 0);
  EXPECT_EQ(at_both_levels(flat, flat, any_planar_arm(Vector<2>(1.0, 0.8)), flat_elbow), 0);
}

/// The first task again as the second, with another target: it cannot be met, and u does not change.
TEST(SecondTask, that_contradicts_the_first_is_dropped) {
  const AnyArm<Position<2>> arm = any_planar_arm(Vector<4>(1.0, 0.8, 0.6, 0.4));
  const State<kOpen> state{Vector<4>(0.3, 0.5, -0.8, 1.0), Vector<4>(0.1, 0.2, 0.3, 0.4)};
  Kinematics<Position<2>, kOpen> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  const auto reference = Reference<Position<2>>::hold(kinematics.tip);
  const auto elsewhere = Reference<Position<2>>::hold(Rows(-1.0, 1.0));
  Joints own = state.q;
  Joints u = state.q;
  const auto scheme = planar_scheme();
  ASSERT_EQ(scheme.resolve(kinematics, reference, state, own), Status::kOk);
  ASSERT_EQ(SecondTask(scheme, arm, elsewhere, 1.0, 1.0).resolve(kinematics, reference, state, u), Status::kOk);
  EXPECT_LE((u - own).norm(), 1e-9);
}

TEST(SecondTask, refuses_what_makes_no_sense) {
  const AnyArm<Position<2>> elbow = any_planar_arm(Vector<3>::Ones());
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
  const AnyArm<Position<2>> arm = planar_arm();
  const AnyArm<Position<2>> elbow = planar_elbow();
  const auto attempt = [&](const Joints& q, const Rows& x) {
    const State<kOpen> state{q, Vector<4>::Zero()};
    Kinematics<Position<2>, kOpen> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    Joints u = Vector<4>::Constant(42.0);
    const Status status = SecondTask(planar_scheme(), elbow, Reference<Position<2>>::hold(x), 1.0, 1.0)
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
  const AnyArm<Position<2>> arm = planar_arm();
  const AnyArm<Position<2>> elbow = planar_elbow();
  const State<kOpen> start = planar_start();
  const AnyPath<Position<2>> circle(Path(Circle(0.15), kDuration));
  const Rows where = tip_of(elbow, start.q.head<2>());
  const auto elbow_error = [&](const auto& scheme) {
    const auto run = recorded(arm, circle, erased(scheme), start, TimeGrid<>(kDuration, 1e-2, 1.0));
    EXPECT_EQ(run.result.status, Status::kOk);
    EXPECT_LE(run.max_error(), 1e-9);
    double largest = 0.0;
    for (const auto& sample : run.samples) {
      largest = std::max(largest, (tip_of(elbow, sample.q.template head<2>()) - where).norm());
    }
    return largest;
  };
  const auto hold = Reference<Position<2>>::hold(where);
  EXPECT_LE(elbow_error(SecondTask(planar_scheme(), elbow, hold, 4.0, 4.0)), 1e-9);
  EXPECT_GT(elbow_error(planar_scheme()), 1e-2);
  EXPECT_LE(elbow_error(SecondTask(MVN<kOpen>(1.0), elbow, hold, 0.0, 4.0)), 1e-9);
  EXPECT_GT(elbow_error(MVN<kOpen>(1.0)), 1e-2);
}

/// A wrist that starts 20 degrees off turns to the desired direction, while the tip goes round a circle.
TEST(SecondTask, turns_the_gaze) {
  const AnyArm<Position<3>> arm = any_arm(presets::panda());
  const State<kOpen> start{panda_ready(), Vector<7>::Zero()};
  Kinematics<Pose, kOpen> pose;
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
  const AnyArm<Position<2>> arm = planar_arm();
  const AnyArm<Position<2>> elbow = planar_elbow();
  const State<kOpen> start = planar_start();
  const AnyPath<Position<2>> circle(Path(Circle(0.01), 1.0));
  const auto far = Reference<Position<2>>::hold(Rows(0.0, 3.0));
  const auto damped = planar_scheme(NullSpace<kOpen>{}.with_damping(5.0));
  const auto run =
      recorded(arm, circle, erased(SecondTask(damped, elbow, far, 4.0, 1.0)), start, TimeGrid<>(1.0, 1e-3, 20.0));
  ASSERT_EQ(run.result.status, Status::kOk);
  EXPECT_LE(run.max_error(), 1e-8);
  EXPECT_LE(run.result.last.qd.norm(), 1e-3);
  for (const auto& sample : run.samples) ASSERT_LE(sample.qd.norm(), 5.0) << "at t = " << sample.t;
}

/// The caller may change the reference between calls.
TEST(SecondTask, follows_a_reference_that_is_replaced) {
  const AnyArm<Position<2>> arm = planar_arm();
  const AnyArm<Position<2>> elbow = planar_elbow();
  State<kOpen> state = planar_start();
  Kinematics<Position<2>, kOpen> kinematics;
  arm.kinematics(state.q, kinematics);
  const auto hold = Reference<Position<2>>::hold(kinematics.tip);
  const Rows middle = tip_of(elbow, state.q.head<2>());
  SecondTask scheme(MVN<kOpen>(5.0), elbow, Reference<Position<2>>::hold(middle), 0.0, 5.0);
  for (int i = 0; i < 1000; ++i) {
    const double t = 1e-3 * i;
    scheme.reference.x = middle + 0.1 * Rows(std::sin(t), std::cos(t) - 1.0);
    scheme.reference.xd = 0.1 * Rows(std::cos(t), -std::sin(t));
    arm.kinematics(state.q, kinematics);
    ASSERT_EQ(scheme.resolve(kinematics, hold, state, state.qd), Status::kOk);
    state.q += 1e-3 * state.qd;
  }
  arm.kinematics(state.q, kinematics);
  const Rows point = tip_of(elbow, state.q.head<2>());
  EXPECT_LE((point - scheme.reference.x).norm(), 2e-4);
  EXPECT_GT((point - middle).norm(), 0.05);
  EXPECT_LE((kinematics.tip - hold.x).norm(), 1e-4);
}

/// Wrapped round an ascent, the second task is met, and the ascent has the joints that are left.
TEST(SecondTask, goes_before_what_it_wraps) {
  const AnyArm<Position<2>> arm = any_planar_arm(Vector<6>::Ones());
  const AnyArm<Position<2>> elbow = planar_elbow();
  const State<kOpen> state{Vector<6>(0.3, 0.6, 0.9, -0.9, 0.4, 0.2), Vector<6>::Constant(0.1)};
  Kinematics<Position<2>, kOpen> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  Kinematics<Position<2>, kOpen> at;
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
}  // namespace fpbm::test::second_task_laws
