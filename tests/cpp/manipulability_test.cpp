#include "fpbm/model/manipulability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fpbm/objective/manipulability_ascent.hpp"
#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/recording.hpp"
#include "support/textbook.hpp"

/// w = √det(JJᵀ), its gradient, and schemes with manipulability ascent.
namespace fpbm::test::manipulability_laws {
namespace {

/// √det(JJᵀ)
Real manipulability_as_written(const RealMatrix& J) {
  return std::sqrt(determinant(J * J.transpose()));
}

template <typename Space, typename Arm>
Real manipulability_as_written(const Arm& arm, const Vector<Arm::kDof>& q) {
  Kinematics<Space, Arm::kDof> kinematics;
  arm.kinematics(q, kinematics);
  const RealMatrix J = real(kinematics.J);
  return manipulability_as_written(J);
}

/// Two links of 1 m: w = |sin q₂|. Here, a determinant would not have a correct digit.
TEST(Manipulability, keeps_its_digits_near_singular_postures) {
  const PlanarArm<2> arm(Vector<2>::Ones());
  Kinematics<Position<2>, 2> kinematics;
  for (const double bend : {1e-3, 1e-6, 1e-9}) {
    arm.kinematics(Vector<2>(0.0, bend), kinematics);
    EXPECT_NEAR(manipulability(kinematics.J), bend, 1e-6 * bend);
  }
  arm.kinematics(Vector<2>::Zero(), kinematics);
  EXPECT_EQ(manipulability(kinematics.J), 0.0);
  EXPECT_EQ(manipulability_gradient<Position<2>>(arm, Vector<2>(0.0, 0.0)), Vector<2>(0.0, 0.0));
  for (const double turn : {0.1, 0.3, 0.7, 2.0}) {
    const PlanarArm<4> straight(Vector<4>(1.0, 0.8, 0.6, 0.4));
    EXPECT_EQ(manipulability_gradient<Position<2>>(straight, Vector<4>(turn, 0.0, 0.0, 0.0)), Vector<4>::Zero());
  }
  // The condition number is 17 for J, and 17² for the linear system with J Jᵀ. The last digits depend on the
  // processor.
  constexpr double kRoundOff = 17 * 17 * std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(manipulability_gradient<Position<2>>(arm, Vector<2>(0.4, 0.3))(1), std::cos(0.3), kRoundOff);
}

TEST(Manipulability, is_the_root_of_the_determinant_and_its_gradient_the_slope) {
  on_every_arm([](const auto& each, const auto& q, const auto&) {
    using Space = typename std::decay_t<decltype(each)>::Space;
    using Joints = std::decay_t<decltype(q)>;
    Kinematics<Space, Joints::RowsAtCompileTime> kinematics;
    const auto as_written = [&](const Joints& at) {
      each.arm.kinematics(at, kinematics);
      return manipulability_as_written(real(kinematics.J));
    };
    const Joints gradient = manipulability_gradient<Space>(each.arm, q);
    ASSERT_EQ(gradient.size(), q.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      constexpr double kStep = 1e-5;
      Joints ahead = q;
      ahead(k) += kStep;
      Joints behind = q;
      behind(k) -= kStep;
      const Real slope = (as_written(ahead) - as_written(behind)) / (2 * static_cast<Real>(kStep));
      EXPECT_NEAR(gradient(k), static_cast<double>(slope), 1e-7) << "joint " << k;
    }
    const Real expected = as_written(q);
    EXPECT_NEAR(manipulability(kinematics.J), static_cast<double>(expected), 1e-13 * kinematics.J.norm());
  });
}

/// u of a scheme alone and with an ascent, for a known gradient.
void expect_ascent(const RealMatrix& J, const RealVector& own, const RealVector& u, const RealVector& gradient) {
  const RealMatrix N_E = RealMatrix::Identity(J.cols(), J.cols()) - pseudoinverse(J) * J;
  EXPECT_LE((u - own - 3 * N_E * gradient).norm(), 1e-11L * (1 + own.norm()));
  EXPECT_LE((J * (u - own)).norm(), 1e-12L * (1 + own.norm()));
}

/// u + gain N∇w with the explicit projector N = I − J⁺J, at either level. J u is the same as for the scheme alone.
template <typename Space, typename Arm>
void expect_ascents(const Arm& arm) {
  using Joints = Vector<Eigen::Dynamic>;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Joints q = random.uniform(arm.dof(), -1.5, 1.5);
    const Joints qd = random.uniform(arm.dof(), -1.0, 1.0);
    Kinematics<Space, Eigen::Dynamic> kinematics;
    arm.kinematics(q, qd, kinematics);
    const auto reference = random_reference(random, kinematics);
    const State<Eigen::Dynamic> state{q, qd};
    const auto check = [&](const auto& scheme) {
      Joints own = q;
      Joints u = q;
      ASSERT_EQ(scheme.resolve(kinematics, reference, state, own), Status::kOk);
      const ManipulabilityAscent ascent(scheme, arm, 3.0);
      ascent.require_dof(q.size());
      ASSERT_EQ(ascent.resolve(kinematics, reference, state, u), Status::kOk);
      expect_ascent(real(kinematics.J), real(own), real(u), real(manipulability_gradient<Space>(arm, q)));
    };
    check(WMVN<Eigen::Dynamic>(Joints(Joints::Ones(q.size())), 1.0));
    check(FPBM<Eigen::Dynamic>(0.6, Joints(random.uniform(q.size(), 0.5, 2.0)), 1.0, 1.0));
  }
}

/// Arms and task spaces enter through the gradient only, which the law above covers.
TEST(ManipulabilityAscent, equals_the_textbook) {
  for (const int dof : {4, 6}) expect_ascents<Position<2>>(any_planar_arm(Vector<Eigen::Dynamic>::Ones(dof)));
  for (const Chain<>& chain : {presets::panda(), panda_on_rail(), coupled_panda()}) {
    expect_ascents<Pose>(any_arm(chain));
  }
}

TEST(ManipulabilityAscent, commutes_with_further_objectives) {
  const PlanarArm<4> arm = paper_arm();
  const State<4> state{paper_start().q, Vector<4>(0.1, 0.2, -0.3, 0.1)};
  Kinematics<Position<2>, 4> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  const auto reference = Reference<Position<2>>::hold(kinematics.tip);
  const auto answer = [&](const auto& scheme) {
    Vector<4> u;
    EXPECT_EQ(scheme.resolve(kinematics, reference, state, u), Status::kOk);
    return u;
  };
  const auto with = [&](const NullSpace<4>& z) { return paper_fpbm(z); };
  const NullSpace<4> z = NullSpace<4>{}.with_damping(2.0).with_rest_posture(Vector<4>::Ones(), 1.0);
  const Vector<4> bare = answer(with({}));
  const Vector<4> sum = answer(with(z)) + answer(ManipulabilityAscent(with({}), arm, 2.0)) - bare;
  EXPECT_LE((answer(ManipulabilityAscent(with(z), arm, 2.0)) - sum).norm(), 1e-12);
  const ManipulabilityAscent once(with({}), arm, 0.5);
  EXPECT_LE((answer(ManipulabilityAscent(once, arm, 1.5)) - answer(ManipulabilityAscent(with({}), arm, 2.0))).norm(),
            1e-12);
  EXPECT_EQ(answer(ManipulabilityAscent(with({}), arm, 0.0)), bare);
}

TEST(ManipulabilityAscent, rejects_invalid_arguments) {
  const PlanarArm<Eigen::Dynamic> arm(Vector<4>::Ones());
  const auto scheme = MVN<Eigen::Dynamic>();
  for (const double gain : {-1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(complaint([&] { ManipulabilityAscent(scheme, arm, gain); }).find("manipulability_gain = "),
              std::string::npos);
  }
  EXPECT_NE(
      complaint([&] { ManipulabilityAscent(scheme, arm, 1.0).require_dof(5); }).find("has 4 entries: must have 5"),
      std::string::npos);
  const auto narrow = MVN<Eigen::Dynamic>(0.0, NullSpace<Eigen::Dynamic>{}.with_free_choice(Vector<3>::Ones()));
  EXPECT_NE(complaint([&] { ManipulabilityAscent(narrow, arm, 1.0).require_dof(4); }), "");
}

/// If the scheme fails, the ascent returns the same status and does not change u.
TEST(ManipulabilityAscent, returns_failures_of_the_scheme) {
  const PlanarArm<4> arm = paper_arm();
  const auto attempt = [&](const Vector<4>& q, const Vector<2>& x) {
    const State<4> state{q, Vector<4>::Zero()};
    Kinematics<Position<2>, 4> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    Vector<4> u = Vector<4>::Constant(42.0);
    const Status status =
        ManipulabilityAscent(paper_fpbm(), arm, 1.0).resolve(kinematics, Reference<Position<2>>::hold(x), state, u);
    EXPECT_EQ(failed(status), u == Vector<4>::Constant(42.0));
    return status;
  };
  EXPECT_EQ(attempt(paper_start().q, Vector<2>(3.0, 2.0)), Status::kOk);
  EXPECT_EQ(attempt(Vector<4>::Zero(), Vector<2>(3.0, 2.0)), Status::kSingular);
  EXPECT_EQ(attempt(paper_start().q, Vector<2>(kPi / 0.0, 2.0)), Status::kNotFinite);
}

/// After a circle and a hold, at either level, w is at its maximum over the self-motion, and the tip has followed its
/// path.
template <typename Scheme>
void expect_to_climb(const Scheme& scheme, double gain) {
  const PlanarArm<4> arm = paper_arm();
  const TimeGrid<> grid(kDuration, 5e-3, 2.0 * kDuration);
  const State<Eigen::Dynamic> start{paper_start().q, paper_start().qd};
  const auto without = recorded(arm, paper_circle(), scheme, paper_start(), grid);
  const auto with = recorded(any_planar_arm(Vector<4>::Ones()), paper_circle(),
                             erased(ManipulabilityAscent(scheme, arm, gain)), start, grid);
  ASSERT_EQ(with.result.status, Status::kOk);
  EXPECT_LE(with.max_error(), 1e-8);
  const Vector<4> end = with.result.last.q;
  EXPECT_GT(manipulability_as_written<Position<2>>(arm, end),
            1.02L * manipulability_as_written<Position<2>>(arm, without.result.last.q));
  Kinematics<Position<2>, 4> kinematics;
  arm.kinematics(end, kinematics);
  const auto Z = null_basis(kinematics.J);
  EXPECT_LE((Z.transpose() * manipulability_gradient<Position<2>>(arm, end)).norm(), 1e-4);
  EXPECT_LE(with.result.last.qd.norm(), 1e-3);
}

TEST(ManipulabilityAscent, increases_manipulability_without_tip_motion) {
  expect_to_climb(MVN<4>(1.0), 0.2);
  expect_to_climb(paper_fpbm(NullSpace<4>{}.with_damping(3.0)), 0.5);
}

}  // namespace
}  // namespace fpbm::test::manipulability_laws
