#include <gtest/gtest.h>

#include <cstddef>

#include "support/paper.hpp"
#include "support/random.hpp"
#include "support/recording.hpp"
#include "support/subjects.hpp"

/// Theorem 1: the time derivative of the weighted minimum velocity norm (7) is (9).
namespace fpbm::test::theorem_laws {
namespace {

/// Number of pairs among the subjects with weights and in double.
#ifdef FPBM_FEW_TYPES
constexpr std::size_t kPairs = 9;
#else
constexpr std::size_t kPairs = 13;
#endif

/// Subjects of (7), each with the subject of (9) on the same arm with the same weights.
std::vector<std::pair<Subject, Subject>> pairs() {
  std::vector<std::pair<Subject, Subject>> all;
  for (const Subject& velocity : subjects()) {
    if (velocity.takes.acceleration || !velocity.takes.weights || velocity.epsilon > 1e-10) continue;
    for (const Subject& acceleration : subjects()) {
      const std::string partner = "WMVNAcceleration" + velocity.name.substr(std::string("WMVN").size());
      if (acceleration.name == partner) all.emplace_back(velocity, acceleration);
    }
  }
  return all;
}

/// At one instant: along qd = J_W⁺xd, with the derivative xdd of xd, the derivative of (7) is (9).
TEST(Theorem1, is_true_at_every_instant) {
  EXPECT_EQ(pairs().size(), kPairs);
  for (const auto& pair : pairs()) {
    const Subject& velocity = pair.first;
    const Subject& acceleration = pair.second;
    SCOPED_TRACE(velocity.name);
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      Random random(seed);
      Scene scene = random_scene(random, velocity, Regime::kRegular);
      Law law = random_law(random, velocity, false);
      law.k = 0.0;
      Law differentiated = law;
      differentiated.acceleration = true;
      differentiated.k1 = differentiated.k2 = 0.0;
      scene.qd = velocity.resolve(law, scene).u.cast<double>();
      const RealVector qdd = acceleration.resolve(differentiated, scene).u;

      constexpr double kStep = 1e-5;
      const auto at = [&](double t) {
        Scene moved = scene;
        moved.q += t * scene.qd;
        moved.xd += t * scene.xdd;
        return velocity.resolve(law, moved).u;
      };
      const RealVector slope = (at(kStep) - at(-kStep)) / (2 * static_cast<Real>(kStep));
      EXPECT_LE((qdd - slope).norm(), 1e-7L * (1 + qdd.norm())) << "seed " << seed;
    }
  }
}

/// Over a whole motion from a consistent start, (7) and (9) give the same result.
template <typename Weights, typename Arm, typename Path>
void expect_same_motion(const Arm& arm, const Path& path, const Weights& weights, Vector<Arm::kDof> q0) {
  constexpr int N = Arm::kDof;
  const TimeGrid<> grid(path.duration(), 1e-3);
  const State<N> at_rest{q0, 0.0 * q0};
  const auto velocity = recorded(arm, path, WMVN<N>(weights), at_rest, grid);
  ASSERT_EQ(velocity.result.status, Status::kOk);
  const State<N> start{q0, velocity.samples.front().qd};
  const auto acceleration = recorded(arm, path, WMVNAcceleration<N>(weights), start, grid);
  ASSERT_EQ(acceleration.result.status, Status::kOk);
  ASSERT_EQ(velocity.samples.size(), acceleration.samples.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < velocity.samples.size(); ++i) {
    worst = std::max({worst, (velocity.samples[i].q - acceleration.samples[i].q).norm(),
                      (velocity.samples[i].qd - acceleration.samples[i].qd).norm()});
  }
  EXPECT_LE(worst, 1e-9);
}

TEST(Theorem1, is_true_over_the_papers_circle) {
  expect_same_motion(paper_arm(), paper_circle(), paper_weights(), paper_start().q);
}

/// From a start in motion, which the time law of the paper does not have, with dense weights.
TEST(Theorem1, is_true_from_a_start_in_motion) {
  const Vector<7> q0 = Vector<7>::Constant(0.25);
  const DenseWeights<7> weights(Matrix<7, 7>(Random(5).positive_definite(7)));
  const Path<Circle<>, ConstantSpeed> path(Circle<>(0.5), 5.0);
  expect_same_motion(PlanarArm<7>(Vector<7>::Constant(0.5)), path, weights, q0);
}

}  // namespace
}  // namespace fpbm::test::theorem_laws
