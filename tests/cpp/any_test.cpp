#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <utility>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/any/any_scheme.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/any/detail/any_time_law.hpp"
#include "fpbm/any/detail/any_weights.hpp"
#include "fpbm/any/detail/convert_path.hpp"
#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"
#include "support/paper.hpp"
#include "support/recording.hpp"
#include "support/schemes.hpp"

/// Types known only at run time give bitwise the same results as code of fixed size.
namespace fpbm::test::any_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;

template <typename A, typename B>
void expect_same(const A& a, const B& b, const char* what) {
  ASSERT_EQ(a.rows(), b.rows()) << what;
  ASSERT_EQ(a.cols(), b.cols()) << what;
  EXPECT_TRUE(a == b) << what;
}
void expect_same(const Transform<>& a, const Transform<>& b, const char* what) {
  expect_same(a.p, b.p, what);
  expect_same(a.R, b.R, what);
}

template <typename Space, typename Any, typename Arm>
void expect_same_kinematics(const Any& any, const Arm& arm) {
  constexpr int N = Arm::kDof;
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector<N> q = random.uniform(arm.dof(), -2.0, 2.0);
    const Vector<N> qd = random.uniform(arm.dof(), -1.0, 1.0);
    Kinematics<Space, N> expected;
    Kinematics<Space, kOpen> found;
    arm.kinematics(q, qd, expected);
    any.kinematics(q, qd, found);
    expect_same(found.tip, expected.tip, "tip");
    expect_same(found.J, expected.J, "J");
    expect_same(found.Jd, expected.Jd, "Jd");
    const auto Jd = found.Jd;
    any.kinematics(Vector<kOpen>(2.0 * q), found);
    arm.kinematics(Vector<N>(2.0 * q), expected);
    expect_same(found.J, expected.J, "J without a rate");
    expect_same(found.Jd, Jd, "Jd, which stays");
  }
}

template <typename Positions, typename Arm>
void expect_same_arm(const AnyArm<Positions>& any, const Arm& arm) {
  EXPECT_EQ(any.dof(), arm.dof());
  expect_same(any.limits().lower, arm.limits().lower, "lower");
  expect_same(any.limits().upper, arm.limits().upper, "upper");
  expect_same(any.limits().velocity, arm.limits().velocity, "velocity");
  expect_same(any.limits().acceleration, arm.limits().acceleration, "acceleration");
  expect_same_kinematics<Positions>(any, arm);
  expect_same_kinematics<typename PoseOver<Positions>::type>(any, arm);
}

TEST(AnyArm, is_the_arm_that_it_holds) {
  const auto check = [](auto positions, const auto& arm) { expect_same_arm(AnyArm<decltype(positions)>(arm), arm); };
  check(Position<2>{}, PlanarArm<4>(Vector<4>(1.0, 0.8, 0.6, 0.4)));
  check(Position<2>{}, PlanarArm<kOpen>(Vector<6>::Ones()));
  check(Position<3>{}, SerialArm<7>(presets::panda()));
  check(Position<3>{}, CoupledArm<kOpen>(coupled_panda()));
}

/// any_arm() and any_planar_arm() of arms.hpp call make_arm() and make_planar_arm().
TEST(AnyArm, is_made_of_a_chain_or_of_lengths) {
  for (const int dof : {2, 4, 9}) {
    const Vector<kOpen> lengths = Random(1).uniform(dof, 0.5, 1.5);
    expect_same_arm(any_planar_arm(lengths), PlanarArm<kOpen>(lengths));
  }
  expect_same_arm(any_arm(presets::panda()), SerialArm<7>(presets::panda()));
  expect_same_arm(any_arm(panda_on_rail()), SerialArm<kOpen>(panda_on_rail()));
  expect_same_arm(any_arm(coupled_panda()), CoupledArm<kOpen>(coupled_panda()));
  EXPECT_NE(complaint([] { (void)any_planar_arm(Vector<kOpen>::Constant(4, -1.0)); }).find("lengths[0] = -1"),
            std::string::npos);
  EXPECT_NE(complaint([] { (void)any_arm({}); }).find("joints has 0 entries"), std::string::npos);
}

/// Counts its copies.
struct CountedArm : PlanarArm<4> {
  CountedArm() : PlanarArm<4>(Vector<4>::Ones()) {}
  CountedArm(const CountedArm& other) : PlanarArm<4>(other) { ++copies; }
  static inline int copies = 0;
};

TEST(AnyArm, shares_its_arm_with_its_copies) {
  const CountedArm arm;
  CountedArm::copies = 0;
  const AnyArm<Position<2>> any(arm);
  EXPECT_EQ(CountedArm::copies, 1);
  const AnyArm<Position<2>> copy = any;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(CountedArm::copies, 1);
  expect_same_arm(copy, arm);
}

/// In regular postures, in a singular posture, and with a reference that is not finite.
template <typename Space, typename Arm, typename Scheme>
void expect_same_answers(const Arm& arm, const Scheme& scheme) {
  constexpr int N = Arm::kDof;
  const int dof = arm.dof();
  const AnyScheme<Scheme::kLevel, Space> held(scheme);
  const auto any = held;
  EXPECT_EQ(complaint([&] { any.require_dof(dof); }), "");
  EXPECT_EQ(complaint([&] { any.require_dof(dof + 1); }), complaint([&] { scheme.require_dof(dof + 1); }));
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    State<N> state{random.uniform(dof, -1.5, 1.5), random.uniform(dof, -1.0, 1.0)};
    if (trial == 0) state.q.setZero();
    Kinematics<Space, N> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    auto reference = random_reference(random, kinematics);
    if (trial == 1) reference.xd(1) = reference.xdd(1) = std::numeric_limits<double>::quiet_NaN();
    Kinematics<Space, kOpen> any_kinematics;
    any_kinematics.tip = kinematics.tip;
    any_kinematics.length = kinematics.length;
    any_kinematics.J = kinematics.J;
    any_kinematics.Jd = kinematics.Jd;
    const State<kOpen> any_state{state.q, state.qd};
    Vector<N> expected = Vector<N>::Constant(dof, 42.0);
    Vector<kOpen> found = expected;
    const Status status = scheme.resolve(kinematics, reference, state, expected);
    EXPECT_EQ(any.resolve(any_kinematics, reference, any_state, found), status);
    EXPECT_EQ(failed(status), trial < 2) << message(status);
    expect_same(found, expected, "u");
  }
}

TEST(AnyScheme, is_the_scheme_that_it_holds) {
  for_every_scheme<4, double, Kinds::kDiagonal>([](const std::string& name, const Takes& takes, const auto& make) {
    SCOPED_TRACE(name);
    Random random(5);
    Law law;
    law.alpha = 0.6;
    law.k = law.k1 = law.k2 = 2.0;
    law.W = takes.dense ? random.positive_definite(4) : Eigen::MatrixXd(random.uniform(4, 0.5, 4.0).asDiagonal());
    law.has_null_space = true;
    law.damping = law.stiffness = 1.5;
    law.q_rest = law.c = random.uniform(4, -1.0, 1.0);
    expect_same_answers<Position<2>>(PlanarArm<4>(Vector<4>(1.0, 0.8, 0.6, 0.4)), make(law));
  });
  const auto wmvn = WMVN<7>(Vector<7>(Vector<7>::LinSpaced(1.0, 2.0)), 10.0);
  expect_same_answers<Pose>(SerialArm<7>(presets::panda()), wmvn);
  expect_same_answers<Position<2>>(PlanarArm<kOpen>(Vector<6>::Ones()), MVN<kOpen>(1.0));
}

/// AnyWeights gives the results of the weights that it holds. subjects.hpp has schemes with each type of weights.
TEST(AnyWeights, are_the_weights_that_they_hold) {
  Random random(8);
  const Vector<kOpen> a = random.uniform(6, -1.0, 1.0);
  const Matrix<2, kOpen> J = random.uniform(2, 6, -1.0, 1.0);
  const Matrix<kOpen, 2> Jt = J.transpose();
  const auto check = [&](const auto& weights) {
    const AnyWeights any(weights);
    EXPECT_EQ(complaint([&] { any.require_dof(5); }), complaint([&] { weights.require_dof(5); }));
    EXPECT_EQ(any.is_unit(), weights.is_unit());
    EXPECT_EQ(any.template inverse_bound<double>(), weights.template inverse_bound<double>());
    expect_same(any.root(a), Vector<kOpen>(weights.root(a)), "root");
    expect_same(any.inverse_root(a), Vector<kOpen>(weights.inverse_root(a)), "inverse_root");
    expect_same(any.root_transpose(Jt), Matrix<kOpen, 2>(weights.root_transpose(Jt)), "root_transpose");
    const auto found = any.with_unit(J);
    const auto expected = weights.with_unit(J);
    for (Eigen::Index i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(found(i).first(), expected(i).first());
      EXPECT_EQ(found(i).second(), expected(i).second());
    }
  };
  check(UnitWeights{});
  check(DiagonalWeights<kOpen>(Vector<kOpen>(random.uniform(6, 0.5, 4.0))));
  check(DenseWeights<kOpen>(Matrix<kOpen, kOpen>(random.positive_definite(6))));
}

TEST(AnyTimeLaw, is_the_law_of_its_name) {
  const auto check = [](const char* name, auto law) {
    const AnyTimeLaw any(name);
    for (double tau = 0.0; tau <= 1.0; tau += 0.125) {
      const auto expected = decltype(law)::at(tau);
      const auto found = any.at(tau);
      EXPECT_EQ(found.s, expected.s);
      EXPECT_EQ(found.sd, expected.sd);
      EXPECT_EQ(found.sdd, expected.sdd);
    }
  };
  check("sin_squared", SinSquared{});
  check("quintic", Quintic{});
  check("constant_speed", ConstantSpeed{});
  EXPECT_NE(complaint([] { AnyTimeLaw("cubic"); }).find("time_law = 'cubic'"), std::string::npos);
}

template <typename Path>
void expect_same_samples(const AnyPath<typename Path::Space>& any, const Path& path) {
  EXPECT_EQ(any.duration(), path.duration());
  const AnyPath<typename Path::Space> copy = any;  // NOLINT(performance-unnecessary-copy-initialization)
  for (double t = -0.5; t < path.duration() + 0.5; t += 0.03125) {
    for (const double since : {t, t - 0.01}) {
      const auto expected = sample_within(path, t, since);
      const auto found = copy.sample(t, since);
      expect_same(found.x, expected.x, "x");
      expect_same(found.xd, expected.xd, "xd");
      expect_same(found.xdd, expected.xdd, "xdd");
    }
    expect_same(any.sample(t).xdd, path.sample(t).xdd, "xdd");
  }
}

TEST(AnyPath, is_the_path_that_it_holds) {
  const Path circle(Circle(0.3), 2.0);
  expect_same_samples(AnyPath<Position<2>>(circle), circle);
  const Sequence both(circle, Path(Line<2>({0.1, 0.2}), 1.0));
  expect_same_samples(AnyPath<Position<2>>(both), both);
}

TEST(AnyPath, is_converted_to_the_space_of_the_task) {
  const Path circle(Circle(0.3), 2.0);
  const AnyPath<Position<2>> flat(circle);
  const InPlane lifted(circle, Vector<3>::UnitX(), Vector<3>::UnitY());
  expect_same_samples(convert_path<Position<2>>(flat), circle);
  expect_same_samples(convert_path<PlanarPose>(flat), WithRotation(circle));
  expect_same_samples(convert_path<Position<3>>(flat), lifted);
  expect_same_samples(convert_path<Pose>(flat), WithRotation(lifted));
  const AnyPath<Position<3>> spatial(lifted);
  expect_same_samples(convert_path<Pose>(spatial), WithRotation(lifted));
  EXPECT_NE(complaint([&] { (void)convert_path<Position<2>>(spatial); }), "");
  EXPECT_NE(complaint([&] { (void)convert_path<PlanarPose>(spatial); }), "");
  const AnyPath<Pose> turning(WithRotation(lifted, Vector<3>(0.1, 0.2, 0.3)));
  EXPECT_NE(complaint([&] { (void)convert_path<Position<3>>(turning); }), "");
  EXPECT_NE(complaint([&] { (void)convert_path<PlanarPose>(turning); }), "");
}

/// Whole motions and ticks. Code outside the type-erased interface is of run-time size, and may round sums in another
/// order.
TEST(Any, motions_are_those_of_fixed_size) {
  const AnyArm<Position<2>> arm(paper_arm());
  const AnyPath<Position<2>> path(Path(Circle(0.45), kDuration));
  const auto scheme = FPBM<kOpen>(0.6, Vector<kOpen>(Vector<4>(1.0, 2.0, 3.0, 4.0)), 1.0, 1.0);
  const State<kOpen> start{paper_start().q, paper_start().qd};
  const TimeGrid<> grid(kDuration, 1e-2, 1.0);
  const auto expected = recorded(paper_arm(), path, paper_fpbm(), paper_start(), grid).result;
  const auto found = recorded(arm, path, erased(scheme), start, grid).result;
  EXPECT_EQ(found.status, expected.status);
  EXPECT_EQ(found.samples, expected.samples);
  EXPECT_LE((found.last.q - expected.last.q).norm() + (found.last.qd - expected.last.qd).norm(), 1e-13);

  CompiledTracker fixed(paper_arm(), Position<2>{}, paper_fpbm(), paper_start().q);
  CompiledTracker any(arm, Position<2>{}, scheme, Vector<kOpen>(paper_start().q));
  PathFollower fixed_follower(path, fixed.tip());
  PathFollower any_follower(path, any.tip());
  for (int i = 0; i < 2000; ++i) {
    const auto a = fixed.tick(fixed_follower);
    const auto b = any.tick(any_follower);
    ASSERT_EQ(a.status, b.status);
    ASSERT_LE((a.q - b.q).norm() + (a.qd - b.qd).norm(), 2e-13) << i;
  }
}

}  // namespace
}  // namespace fpbm::test::any_laws
