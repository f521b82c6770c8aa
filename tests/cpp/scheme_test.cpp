#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "support/subjects.hpp"

/// Laws of every scheme, on every arm, for every number of joints and Scalar.
namespace fpbm::test::scheme_laws {
namespace {

double condition(const RealMatrix& gram) {
  return static_cast<double>(gram.norm() * inverse(gram).norm());
}

double distance(const RealVector& a, const RealVector& b) {
  return static_cast<double>((a - b).norm());
}

class SchemeLaws : public ::testing::TestWithParam<Subject> {
 protected:
  /// Calls check(scene, law) on random arms, states and parameters in each regime, without and with z.
  template <typename Check>
  void everywhere(Check&& check) {
    for (const Regime regime : {Regime::kRegular, Regime::kNearSingular, Regime::kAtRest}) {
      for (const bool has_null_space : {false, true}) {
        for (std::uint32_t seed = 0; seed < 20; ++seed) {
          SCOPED_TRACE(name(regime) + (has_null_space ? " with z" : " without z") + ", seed " + std::to_string(seed));
          Random random(seed);
          const Scene scene = random_scene(random, GetParam(), regime);
          check(scene, random_law(random, GetParam(), has_null_space));
        }
      }
    }
  }

  /// The result for a scene that the subject must resolve.
  static Outcome resolved(const Law& law, const Scene& scene) {
    Outcome outcome = GetParam().resolve(law, scene);
    EXPECT_EQ(outcome.status, Status::kOk);
    return outcome;
  }

  /// Expected round-off error of u. The condition numbers of JJᵀ and JW⁻¹Jᵀ enter, which are squares of the condition
  /// number of J. The round-off error of a term may be larger than the sum.
  static double tolerance(const Law& law, const Situation& at) {
    const RealMatrix Winv = inverse(real(law.W));
    const double relative = 8.0 * GetParam().epsilon *
                            std::max(condition(at.J * at.J.transpose()), condition(at.J * Winv * at.J.transpose()));
    if (GetParam().epsilon < 1e-10) {
      EXPECT_LE(relative, 1e-9) << "the scene is too hard for the promised 1e-9";
    }
    const RealVector task_term = pseudoinverse(at.J) * commanded(law, at);
    return relative * static_cast<double>(resolve(law, at).norm() + task_term.norm() + secondary(law, at).norm());
  }
};

/// The results equal (3), (5) to (9), (13) and (16) as printed.
TEST_P(SchemeLaws, equals_the_textbook) {
  everywhere([](const Scene& scene, const Law& law) {
    const Outcome outcome = resolved(law, scene);
    EXPECT_LE(distance(outcome.u, resolve(law, outcome.at)), tolerance(law, outcome.at));
  });
}

/// J qd = v and J qdd = b: the task has priority for all weights, balances and z.
TEST_P(SchemeLaws, moves_the_tip_as_commanded) {
  everywhere([](const Scene& scene, const Law& law) {
    const auto [status, u, at] = resolved(law, scene);
    EXPECT_LE(distance(at.J * u, commanded(law, at)), static_cast<double>(at.J.norm()) * tolerance(law, at));
  });
}

/// J N_W = 0 (Lemma 2): z does not change the task. If a null space exists, z changes u.
TEST_P(SchemeLaws, a_secondary_motion_does_not_change_the_task) {
  everywhere([](const Scene& scene, const Law& law) {
    if (!law.has_null_space) return;
    Law bare = law;
    bare.has_null_space = false;
    const auto [status, u, at] = resolved(law, scene);
    const RealVector without = resolved(bare, scene).u;
    EXPECT_LE(distance(at.J * u, at.J * without), static_cast<double>(at.J.norm()) * tolerance(law, at));
    if (GetParam().dof > GetParam().rows) {
      EXPECT_GT(distance(u, without), 1e-3);
    }
  });
}

/// W → cW changes nothing: only the ratios of the weights matter.
TEST_P(SchemeLaws, only_the_ratios_of_the_weights_matter) {
  everywhere([](const Scene& scene, const Law& law) {
    const Outcome outcome = resolved(law, scene);
    for (const double c : {1e-6, 3.7, 1e8}) {
      Law scaled = law;
      scaled.W *= c;
      EXPECT_LE(distance(outcome.u, resolved(scaled, scene).u), tolerance(law, outcome.at)) << "c = " << c;
    }
  });
}

/// A straight arm cannot move its tip along its links: the scheme rejects the state and does not change u.
TEST_P(SchemeLaws, a_singular_posture_is_rejected) {
  everywhere([](Scene scene, const Law& law) {
    for (const double direction : {0.0, 0.3, 2.0}) {
      scene.q.setZero();
      scene.q(0) = direction;
      const Outcome outcome = GetParam().resolve(law, scene);
      EXPECT_EQ(outcome.status, Status::kSingular);
      EXPECT_TRUE(outcome.untouched());
    }
  });
}

/// For a state or reference that is not finite, the scheme returns a status and does not change u.
TEST_P(SchemeLaws, numbers_that_are_not_finite_are_rejected) {
  const Subject& subject = GetParam();
  const bool acceleration = subject.takes.acceleration;
  everywhere([&](const Scene& good, const Law& law) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      const auto expect_refusal = [&](const char* what, auto&& member) {
        Scene scene = good;
        member(scene)(1) = bad;
        const Outcome outcome = subject.resolve(law, scene);
        EXPECT_EQ(outcome.status, Status::kNotFinite) << what << " = " << bad;
        EXPECT_TRUE(outcome.untouched()) << what << " = " << bad;
      };
      expect_refusal(
          "q", [](Scene & scene) -> auto& { return scene.q; });
      if (acceleration) {
        expect_refusal(
            "qd", [](Scene & scene) -> auto& { return scene.qd; });
        expect_refusal(
            "xdd", [](Scene & scene) -> auto& { return scene.xdd; });
      } else {
        expect_refusal(
            "xd", [](Scene & scene) -> auto& { return scene.xd; });
      }
      if (subject.takes.feedback) {
        expect_refusal(
            "x", [](Scene & scene) -> auto& { return scene.displacement; });
      }
    }
  });
}

INSTANTIATE_TEST_SUITE_P(every, SchemeLaws, ::testing::ValuesIn(subjects()),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace fpbm::test::scheme_laws
