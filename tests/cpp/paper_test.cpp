#include "support/paper.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "support/recording.hpp"

/// The figures and tables of the paper.
namespace fpbm::test::paper_laws {
namespace {

const TimeGrid<>& grid() {
  static const TimeGrid<> result(kDuration, 1e-3);
  return result;
}

void expect_final(const PaperCase& expected, const Recording<4>& run) {
  ASSERT_EQ(run.result.status, Status::kOk) << message(run.result.status);
  EXPECT_EQ(run.samples.size(), 10001U);
  EXPECT_EQ(run.result.time, kDuration);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(run.result.last.q(joint), expected.q[i], 1e-9) << "joint " << i;
    EXPECT_NEAR(run.result.last.qd(joint), expected.qd[i], 1e-9) << "joint " << i;
  }
}

class PaperCases : public ::testing::TestWithParam<PaperCase> {};

TEST_P(PaperCases, end_as_in_the_independent_solution) {
  const PaperCase& expected = GetParam();
  const auto scheme = FPBM<4>(expected.alpha, Vector<4>(expected.weights.data()), expected.k1, expected.k2);
  const Recording<4> run = recorded(paper_arm(), paper_path(expected.figure), scheme, paper_start(), grid());
  expect_final(expected, run);
  if (expected.k2 > 0.0) {
    EXPECT_LE(run.max_error(), 1e-12);
  } else {
    // α = k₁ = k₂ = 0 is MAN (8): MAN() must give the same result.
    expect_final(expected, recorded(paper_arm(), paper_path(expected.figure), MAN<4>(), paper_start(), grid()));
  }
}

INSTANTIATE_TEST_SUITE_P(all, PaperCases, ::testing::ValuesIn(kPaperCases),
                         [](const auto& each) { return "case_" + std::to_string(each.index); });

/// "MAN's tip error diverges and FPBM's does not", with the same integrator and 50 steps for both.
TEST(Paper, man_amplifies_the_tip_error_and_fpbm_does_not) {
  const TimeGrid<> grid(kDuration, 0.2);
  const auto man = recorded(paper_arm(), paper_circle(), MAN<4>(), paper_start(), grid);
  const auto fpbm = recorded(paper_arm(), paper_circle(), paper_fpbm(), paper_start(), grid);
  ASSERT_EQ(man.result.status, Status::kOk);
  ASSERT_EQ(fpbm.result.status, Status::kOk);
  EXPECT_GT(man.max_error(), 10.0 * fpbm.max_error());

  // The error still grows at T: the last error is the largest.
  const double last_tenth = 0.9 * kDuration;
  EXPECT_EQ(man.max_error(), man.max_error(last_tenth));
  EXPECT_EQ(man.max_error(), man.samples.back().error.norm());
  EXPECT_LT(fpbm.max_error(last_tenth), fpbm.max_error());
}

}  // namespace
}  // namespace fpbm::test::paper_laws
