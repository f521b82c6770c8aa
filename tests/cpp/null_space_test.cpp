#include "fpbm/objective/null_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/random.hpp"
#include "support/recording.hpp"

/// Secondary motions that depend on the joint state only.
namespace fpbm::test::null_space_laws {
namespace {

constexpr double kNone = JointBounds<>::kNone;

/// H of Liégeois as printed.
double centring_cost(const JointLimits<4>& limits, const Vector<4>& q) {
  double H = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double middle = (limits.lower(i) + limits.upper(i)) / 2.0;
    H += 0.5 * std::pow((q(i) - middle) / (limits.upper(i) - limits.lower(i)), 2);
  }
  return H;
}

JointLimits<4> some_limits() {
  JointLimits<4> limits = JointLimits<4>::none(4);
  limits.lower = Vector<4>(-1.0, 0.5, -3.0, -0.2);
  limits.upper = Vector<4>(2.0, 1.5, 3.0, 0.1);
  return limits;
}

TEST(NullSpace, centring_descends_the_gradient_of_its_cost) {
  const JointLimits<4> limits = some_limits();
  const auto null_space = NullSpace<4>{}.with_joint_centring(limits, 3.0);
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const State<4> state{random.uniform(4, -2.0, 2.0), random.uniform(4, -2.0, 2.0)};
    const Vector<4> z = null_space.at<Level::kVelocity>(state);
    EXPECT_EQ(null_space.at<Level::kAcceleration>(state), z);
    for (int i = 0; i < 4; ++i) {
      const Vector<4> step = 1e-3 * Vector<4>::Unit(i);
      const double slope = (centring_cost(limits, state.q + step) - centring_cost(limits, state.q - step)) / 2e-3;
      EXPECT_NEAR(z(i), -3.0 * slope, 1e-9) << i;
    }
  }
}

TEST(NullSpace, centring_does_not_move_joints_without_bounds) {
  JointLimits<4> limits = some_limits();
  limits.lower(0) = -kNone;
  limits.upper(2) = kNone;
  limits.lower(3) = -kNone;
  limits.upper(3) = kNone;
  const State<4> state{Vector<4>(5.0, 1.2, -4.0, 7.0), Vector<4>::Zero()};
  const Vector<4> z = NullSpace<4>{}.with_joint_centring(limits, 2.0).at<Level::kVelocity>(state);
  EXPECT_LE((z - Vector<4>(0.0, -2.0 * 0.2, 0.0, 0.0)).norm(), 1e-15);
}

/// All four parts together, in each of the 24 orders, give the sum of the parts.
TEST(NullSpace, parts_add_up_in_any_order) {
  const State<4> state{Vector<4>(0.1, 0.2, -0.3, 0.4), Vector<4>(1.0, -2.0, 3.0, -4.0)};
  const std::array<NullSpace<4> (*)(const NullSpace<4>&), 4> parts = {
      [](const NullSpace<4>& z) { return z.with_damping(2.0); },
      [](const NullSpace<4>& z) { return z.with_rest_posture(Vector<4>(1, 2, 3, 4), 0.5); },
      [](const NullSpace<4>& z) { return z.with_joint_centring(some_limits(), 0.7); },
      [](const NullSpace<4>& z) { return z.with_free_choice(Vector<4>(-1, 0, 1, 2)); }};
  const auto at = [&](const NullSpace<4>& z) { return z.at<Level::kAcceleration>(state); };
  Vector<4> sum = Vector<4>::Zero();
  for (const auto part : parts) sum += at(part({}));
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  do {
    NullSpace<4> z;
    for (const std::size_t i : order) z = parts[i](z);
    EXPECT_LE((at(z) - sum).norm(), 1e-14);
    for (const std::size_t i : order) z = parts[i](z);
    EXPECT_LE((at(z) - 2.0 * sum).norm(), 1e-14) << "each twice";
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(NullSpace, rejects_invalid_arguments) {
  const NullSpace<4> z;
  JointLimits<4> limits = some_limits();
  for (const double gain : {0.0, -1.0, kNone, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NE(complaint([&] { (void)z.with_joint_centring(limits, gain); }).find("joint_centring = "),
              std::string::npos);
  }
  limits.lower(2) = 3.0;
  EXPECT_EQ(complaint([&] { (void)z.with_joint_centring(limits, 1.0); }),
            "limits.lower[2] = 3: must be below limits.upper");
  limits.lower(2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint([&] { (void)z.with_joint_centring(limits, 1.0); }).find("limits.lower[2] = "), std::string::npos);
  const auto three = NullSpace<Eigen::Dynamic>{}.with_free_choice(Vector<3>::Ones());
  EXPECT_NE(complaint([&] {
              (void)three.with_joint_centring(JointLimits<Eigen::Dynamic>::none(4), 1.0);
            }).find("has 4 entries: must have 3"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              NullSpace<Eigen::Dynamic>{}.with_joint_centring(JointLimits<Eigen::Dynamic>::none(4), 1.0).require_dof(3);
            }).find("has 4 entries: must have 3"),
            std::string::npos);
}

/// After a circle and a hold, the joints are nearer to the middle of their ranges, and the tip has followed its path.
TEST(NullSpace, centring_brings_the_joints_to_the_middle) {
  JointLimits<4> limits = JointLimits<4>::none(4);
  limits.lower = Vector<4>(-2.0, -2.0, -2.0, -2.0);
  limits.upper = Vector<4>(2.0, 2.5, 3.0, 1.0);
  const TimeGrid<> grid(kDuration, 5e-3, kDuration);
  const auto damped = NullSpace<4>{}.with_damping(4.0);
  const auto without = recorded(paper_arm(), paper_circle(), paper_fpbm(damped), paper_start(), grid);
  const auto with =
      recorded(paper_arm(), paper_circle(), paper_fpbm(damped.with_joint_centring(limits, 50.0)), paper_start(), grid);
  ASSERT_EQ(with.result.status, Status::kOk);
  EXPECT_LE(with.max_error(), 1e-8);
  EXPECT_LT(centring_cost(limits, with.result.last.q), 0.8 * centring_cost(limits, without.result.last.q));
  EXPECT_LT(with.result.last.qd.norm(), 1e-3);
}

/// Repetitive motion planning: with the start posture as rest posture, at a rate of 2/s at either level, the arm does
/// not drift from circle to circle. Without a rest posture, the arm drifts.
template <typename Scheme>
double drift_in_third_circle(const Scheme& scheme) {
  const TimeGrid<> grid(kDuration, 5e-3);
  State<4> state = paper_start();
  Vector<4> second = state.q;
  for (int circle = 1; circle <= 3; ++circle) {
    if (circle == 3) second = state.q;
    const auto result = recorded(paper_arm(), paper_circle(), scheme, state, grid).result;
    EXPECT_EQ(result.status, Status::kOk);
    state = result.last;
  }
  return (state.q - second).cwiseAbs().maxCoeff();
}

TEST(NullSpace, a_rest_posture_at_the_start_makes_motion_repeat) {
  const Vector<4> start = paper_start().q;
  EXPECT_LE(drift_in_third_circle(paper_fpbm(NullSpace<4>{}.with_damping(4.0).with_rest_posture(start, 4.0))), 1e-6);
  EXPECT_LE(drift_in_third_circle(MVN<4>(1.0, NullSpace<4>{}.with_rest_posture(start, 2.0))), 1e-6);
  EXPECT_GT(drift_in_third_circle(paper_fpbm()), 1e-2);
  EXPECT_GT(drift_in_third_circle(MVN<4>(1.0)), 1e-3);
}

}  // namespace
}  // namespace fpbm::test::null_space_laws
