#include <gtest/gtest.h>

#include <string>

#include "support/random.hpp"
#include "support/textbook.hpp"

/// The lemmas of the paper, in extended precision, check the textbook formulas, on which the other tests rely.
namespace fpbm::test::lemma_laws {
namespace {

struct Subject {
  RealVector lengths;
  RealMatrix W;
  Situation at;
};

/// Calls check(subject) on random arms with diagonal and dense weights.
template <typename Check>
void everywhere(Check&& check) {
  for (const int n : {2, 3, 4, 7, 12}) {
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
      for (const bool dense : {false, true}) {
        SCOPED_TRACE("n = " + std::to_string(n) + ", seed " + std::to_string(seed) + (dense ? ", dense" : ""));
        Random random(seed);
        const RealVector lengths = real(random.uniform(n, 0.5, 1.5));
        const RealMatrix dense_W = real(random.positive_definite(n));
        const RealMatrix diagonal_W = real(random.uniform(n, 0.5, 8.0)).col(0).asDiagonal();
        const RealVector q = real(random.uniform(n, 1.0 / n, 2.0 / n));
        const RealVector qd = real(random.uniform(n, -1.0, 1.0));
        check(Subject{lengths, dense ? dense_W : diagonal_W, planar_arm(lengths, q, qd)});
      }
    }
  }
}

/// Lemma 1: d/dt J_W⁺ = N_W W⁻¹Jdᵀ(JW⁻¹Jᵀ)⁻¹ − J_W⁺ Jd J_W⁺.
TEST(Lemma1, is_the_derivative_of_the_weighted_pseudoinverse) {
  everywhere([](const Subject& subject) {
    const auto& [lengths, W, at] = subject;
    constexpr Real kStep = 1e-6L;
    const RealMatrix ahead = weighted_pseudoinverse(planar_arm(lengths, at.q + kStep * at.qd, at.qd).J, W);
    const RealMatrix behind = weighted_pseudoinverse(planar_arm(lengths, at.q - kStep * at.qd, at.qd).J, W);
    const RealMatrix slope = (ahead - behind) / (2 * kStep);
    const RealMatrix JWp = weighted_pseudoinverse(at.J, W);
    EXPECT_LE((rate_term(at.J, at.Jd, W) - JWp * at.Jd * JWp - slope).norm(), 1e-8L * (1 + slope.norm()));
  });
}

/// Lemma 2: N_W J_W⁺ = 0, (I − J⁺J) J_W⁺ = J_W⁺ − J⁺, N_W N_W = (I − J⁺J) N_W = N_W.
TEST(Lemma2, holds) {
  everywhere([](const Subject& subject) {
    const RealMatrix& J = subject.at.J;
    const RealMatrix JWp = weighted_pseudoinverse(J, subject.W);
    const RealMatrix Jp = pseudoinverse(J);
    const RealMatrix NW = projector(J, subject.W);
    const RealMatrix N = RealMatrix::Identity(J.cols(), J.cols()) - Jp * J;
    constexpr Real kRoundOff = 1e-15L;
    EXPECT_LE((NW * JWp).norm(), kRoundOff);
    EXPECT_LE((N * JWp - (JWp - Jp)).norm(), kRoundOff);
    EXPECT_LE((NW * NW - NW).norm(), kRoundOff);
    EXPECT_LE((N * NW - NW).norm(), kRoundOff);
    EXPECT_LE((J * NW).norm(), kRoundOff);
  });
}

/// Both pseudoinverses are right inverses, and equal for W = I.
TEST(Textbook, pseudoinverses_invert) {
  everywhere([](const Subject& subject) {
    const RealMatrix& J = subject.at.J;
    constexpr Real kRoundOff = 1e-15L;
    EXPECT_LE((J * pseudoinverse(J) - RealMatrix::Identity(2, 2)).norm(), kRoundOff);
    EXPECT_LE((J * weighted_pseudoinverse(J, subject.W) - RealMatrix::Identity(2, 2)).norm(), kRoundOff);
    EXPECT_LE((weighted_pseudoinverse(J, RealMatrix::Identity(J.cols(), J.cols())) - pseudoinverse(J)).norm(),
              kRoundOff);
  });
}

}  // namespace
}  // namespace fpbm::test::lemma_laws
