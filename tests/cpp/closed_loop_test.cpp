#include "fpbm/simulate/detail/closed_loop.hpp"

#include <gtest/gtest.h>

#include "support/arms.hpp"
#include "support/paper.hpp"

/// dX/dt of an arm under a scheme, with X = q or X = [q, qd].
namespace fpbm::test::closed_loop_laws {
namespace {

/// Evaluates a loop at X in a regular and in a singular posture. Calls check(X, dX, kinematics, reference, loop).
template <typename Scheme, typename Check>
void on_the_planar_arm(const Scheme& scheme, Check&& check) {
  using Loop = ClosedLoop<PlanarArm<4>, Scheme, Position<2>>;
  const PlanarArm<4> arm = paper_arm();
  const State<4> start = paper_start();
  Loop loop{arm, scheme, {}, start, Vector<4>::Zero()};
  Random random(2);
  typename Loop::X x = random.uniform(4, Loop::kSecondOrder ? 2 : 1, 0.2, 0.8);
  Kinematics<Position<2>, 4> kinematics;
  arm.kinematics(Vector<4>(x.col(0)), Vector<4>(x.col(x.cols() - 1)), kinematics);
  const auto reference = random_reference(random, kinematics);
  typename Loop::X dx = Loop::X::Zero();
  EXPECT_EQ(loop.evaluate(reference, x, dx), Status::kOk);
  EXPECT_EQ(loop.kinematics.tip, kinematics.tip);
  EXPECT_EQ(loop.kinematics.J, kinematics.J);
  EXPECT_EQ(loop.state.q, x.col(0));
  check(x, dx, kinematics, reference, loop);

  const Vector<4> motion = loop.motion();
  EXPECT_EQ(loop.resolve(reference), Status::kOk);
  EXPECT_EQ(loop.motion(), motion) << "resolve() is the second part of evaluate()";

  x.setZero();
  const typename Loop::X before = dx;
  EXPECT_EQ(loop.evaluate(reference, x, dx), Status::kSingular);
  EXPECT_EQ(dx, before) << "where the scheme fails, dX stays as it was";
}

TEST(ClosedLoop, of_the_first_order_has_the_scheme_s_velocity) {
  const auto scheme = WMVN<4>(Vector<4>(1, 2, 3, 4), 3.0);
  on_the_planar_arm(scheme,
                    [&](const auto&, const auto& dx, const auto& kinematics, const auto& reference, const auto& loop) {
                      Vector<4> qd;
                      EXPECT_EQ(scheme.resolve(kinematics, reference, loop.state, qd), Status::kOk);
                      EXPECT_EQ(dx, qd);
                      EXPECT_EQ(loop.state.qd, qd);
                      EXPECT_EQ(loop.qdd, Vector<4>::Zero());
                    });
}

TEST(ClosedLoop, of_the_second_order_has_the_scheme_s_acceleration) {
  const auto scheme = paper_fpbm(NullSpace<4>{}.with_damping(2.0));
  on_the_planar_arm(
      scheme, [&](const auto& x, const auto& dx, const auto& kinematics, const auto& reference, const auto& loop) {
        const State<4> state{x.col(0), x.col(1)};
        Vector<4> qdd;
        EXPECT_EQ(scheme.resolve(kinematics, reference, state, qdd), Status::kOk);
        EXPECT_EQ(dx.col(0), x.col(1));
        EXPECT_EQ(dx.col(1), qdd);
        EXPECT_EQ(loop.state.qd, x.col(1));
        EXPECT_EQ(loop.kinematics.Jd, kinematics.Jd);
        EXPECT_EQ(loop.qdd, qdd);
      });
}

}  // namespace
}  // namespace fpbm::test::closed_loop_laws
