#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm/any/any_scheme.hpp"
#include "support/arms.hpp"
#include "support/paper.hpp"
#include "support/recording.hpp"

/// Invalid arguments throw std::invalid_argument. The message contains the argument, the index and the value.
namespace fpbm::test::bad_input_laws {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
using Open = Vector<Eigen::Dynamic>;
using OpenSquare = Matrix<Eigen::Dynamic, Eigen::Dynamic>;

template <typename Call>
void expect_refusal(Call&& call, const std::vector<std::string>& words) {
  try {
    call();
  } catch (const std::invalid_argument& refusal) {
    const std::string said = refusal.what();
    for (const std::string& word : words) {
      EXPECT_NE(said.find(word), std::string::npos) << "'" << said << "' does not say '" << word << "'";
    }
    return;
  }
  ADD_FAILURE() << "accepted: " << words.front();
}

/// A number in the format of messages, snprintf's %g.
std::string text(double value) {
  if (value == kInf) return "inf";
  if (value == -kInf) return "-inf";
  return value == value ? std::to_string(value).substr(0, value < 0.0 ? 4 : 3) : "nan";
}

const std::vector<double> kNotPositive = {0.0, -1.5, kNaN, kInf, -kInf};
const std::vector<double> kNegative = {-1.5, kNaN, kInf, -kInf};
const std::vector<double> kNotFinite = {kNaN, kInf, -kInf};

/// The part " = value:" of a message.
std::string value(double bad) {
  return " = " + (bad == 0.0 ? std::string("0:") : text(bad) + ":");
}

TEST(BadInput, lengths) {
  for (const double bad : kNotPositive) {
    expect_refusal([&] { PlanarArm<3>(Vector<3>(1.0, 1.0, bad)); }, {"lengths[2]" + value(bad), "positive"});
    expect_refusal([&] { PlanarArm<Eigen::Dynamic>(Open{{bad, 1.0}}); }, {"lengths[0]" + value(bad)});
  }
  expect_refusal([] { PlanarArm<2, float>(Vector<2, float>(1.0F, -1.5F)); }, {"lengths[1] = -1.5:"});
}

TEST(BadInput, number_of_joints) {
  for (const int bad : {0, 1}) {  // More than kMaxDof entries fail an assertion of Eigen.
    expect_refusal([&] { PlanarArm<Eigen::Dynamic>(Open(Open::Ones(bad))); },
                   {"lengths has " + std::to_string(bad) + " entries", "2 to 64"});
  }
  expect_refusal([] { DiagonalWeights<Eigen::Dynamic>{Open(0)}; }, {"weights has 0 entries", "1 to 64"});
  EXPECT_EQ(PlanarArm<Eigen::Dynamic>(Open(Open::Ones(2))).dof(), 2);
  EXPECT_EQ(PlanarArm<Eigen::Dynamic>(Open(Open::Ones(kMaxDof))).dof(), kMaxDof);
}

TEST(BadInput, weights) {
  for (const double bad : kNotPositive) {
    expect_refusal([&] { DiagonalWeights<3>(Vector<3>(1.0, bad, 1.0)); }, {"weights[1]" + value(bad), "positive"});
  }
  for (const double bad : kNotFinite) {
    Matrix<3, 3> W = Matrix<3, 3>::Identity();
    W(2, 2) = bad;
    expect_refusal([&] { DenseWeights<3>{W}; }, {"weights[2, 2]" + value(bad), "finite"});
  }
  for (const double bad : kNotFinite) {
    Matrix<3, 3> W = Matrix<3, 3>::Identity();
    W(1, 2) = bad;
    expect_refusal([&] { DenseWeights<3>{W}; }, {"weights["});
  }
  Matrix<3, 3> asymmetric = Matrix<3, 3>::Identity();
  asymmetric(2, 0) = 0.25;
  expect_refusal([&] { DenseWeights<3>{asymmetric}; }, {"weights[2, 0] = 0.25:", "symmetric"});
  const Matrix<2, 2> indefinite{{1.0, 2.0}, {2.0, 1.0}};
  expect_refusal([&] { DenseWeights<2>{indefinite}; }, {"weights[1, 1]", "positive definite"});
  const Matrix<2, 2> singular{{1.0, 1.0}, {1.0, 1.0}};
  expect_refusal([&] { DenseWeights<2>{singular}; }, {"weights[1, 1]", "positive definite"});
  expect_refusal([] { DenseWeights<Eigen::Dynamic>(OpenSquare(OpenSquare::Ones(3, 2))); }, {"weights", "2", "3"});
}

TEST(BadInput, shapes_and_paths) {
  for (const double bad : kNotPositive) {
    expect_refusal([&] { Circle<>{bad}; }, {"radius" + value(bad)});
    expect_refusal([&] { Tricuspid<>{bad}; }, {"size" + value(bad)});
    expect_refusal([&] { Lissajous<>({1.0, bad}, {2, 1}, 0.0); }, {"amplitudes[1]" + value(bad)});
    expect_refusal([&] { Path<Circle<>>(Circle<>(1.0), bad); }, {"duration" + value(bad)});
  }
  for (const double bad : kNotFinite) {
    expect_refusal([&] { Lissajous<>({1.0, 1.0}, {2, 1}, bad); }, {"phase" + value(bad)});
    expect_refusal([&] { Line<2>(Vector<2>(0.0, bad)); }, {"displacement[1]" + value(bad)});
  }
  expect_refusal([] { Lissajous<>({1.0, 1.0}, {0, 1}, 0.0); }, {"frequencies[0] = 0:"});
  expect_refusal([] { Lissajous<>({1.0, 1.0}, {2, -3}, 0.0); }, {"frequencies[1] = -3:"});
}

TEST(BadInput, gains_and_balance) {
  const DiagonalWeights<4> W = paper_weights();
  for (const double bad : kNegative) {
    expect_refusal([&] { (void)MVN<4>(bad); }, {"k" + value(bad), "not negative"});
    expect_refusal([&] { (void)WMVN<4>(W, bad); }, {"k" + value(bad)});
    expect_refusal([&] { (void)FPBM<4>(0.5, W, bad, 1.0); }, {"k1" + value(bad)});
    expect_refusal([&] { (void)FPBM<4>(0.5, W, 1.0, bad); }, {"k2" + value(bad)});
    expect_refusal([&] { static_cast<void>(NullSpace<4>{}.with_damping(bad)); }, {"null_damping" + value(bad)});
  }
  for (const double bad : {-0.5, 1.5, kNaN, kInf, -kInf}) {
    expect_refusal([&] { (void)FPBM<4>(bad, W, 1.0, 1.0); }, {"alpha" + value(bad), "[0, 1]"});
    expect_refusal([&] { (void)Balanced<4>(bad, W); }, {"alpha" + value(bad), "[0, 1]"});
  }
}

TEST(BadInput, null_space) {
  for (const double bad : kNotFinite) {
    const Vector<3> spoiled(0.0, bad, 0.0);
    expect_refusal([&] { static_cast<void>(NullSpace<3>{}.with_rest_posture(spoiled, 1.0)); },
                   {"rest_posture[1]" + value(bad)});
    expect_refusal([&] { static_cast<void>(NullSpace<3>{}.with_free_choice(spoiled)); }, {"c[1]" + value(bad)});
  }
  for (const double bad : kNotPositive) {
    expect_refusal([&] { static_cast<void>(NullSpace<3>{}.with_rest_posture(Vector<3>::Zero(), bad)); },
                   {"null_stiffness" + value(bad)});
  }
  const auto three = NullSpace<Eigen::Dynamic>{}.with_free_choice(Open::Ones(3));
  expect_refusal([&] { static_cast<void>(three.with_rest_posture(Open::Ones(4), 1.0)); }, {"3", "4"});
}

TEST(BadInput, time_grid) {
  for (const double bad : kNotPositive) {
    expect_refusal([&] { TimeGrid<>(10.0, bad); }, {"dt" + value(bad)});
    expect_refusal([&] { TimeGrid<>(bad, 0.1); }, {"duration" + value(bad)});
  }
  for (const double bad : kNegative) {
    expect_refusal([&] { TimeGrid<>(10.0, 0.1, bad); }, {"hold" + value(bad)});
  }
  expect_refusal([] { TimeGrid<>(1.0, 0.3); }, {"dt = 0.3:", "duration = 1", "nearest is 0.3333333333333333"});
  expect_refusal([] { TimeGrid<>(1.0, 7.0); }, {"dt = 7:", "duration = 1", "nearest is 1"});
  expect_refusal([] { TimeGrid<>(1.0, 0.1, 0.25); }, {"dt = 0.1:", "hold = 0.25"});
  expect_refusal([] { TimeGrid<>(10.0, 1e-9); }, {"dt = 1e-09:"});
  expect_refusal([] { TimeGrid<float>(1.0F, 0.3F); }, {"dt = 0.3", "duration = 1"});

  // The step that the message proposes is accepted.
  EXPECT_EQ(TimeGrid<>(1.0, 0.33333333333333331).motion_steps(), 3);
  EXPECT_EQ(TimeGrid<float>(10.0F, 1e-3F, 0.5F).samples(), 10501);
}

/// Expects that a rollout is rejected.
template <typename Scheme>
void expect_rollout_refusal(const Scheme& scheme, const State<Eigen::Dynamic>& start,
                            const std::vector<std::string>& words, double duration = 10.0) {
  const auto any = erased(scheme);
  const TimeGrid<> grid(duration, 0.1);
  expect_refusal([&] { (void)recorded(any_planar_arm(Open::Ones(4)), paper_circle(), any, start, grid); }, words);
}

AccelerationScheme<Eigen::Dynamic> open_fpbm() {
  return FPBM<Eigen::Dynamic>(0.6, Open(Open::Ones(4)), 1.0, 1.0);
}

TEST(BadInput, start) {
  for (const double bad : kNotFinite) {
    State<4> start = paper_start();
    start.q(2) = bad;
    expect_rollout_refusal(open_fpbm(), {start.q, start.qd}, {"q0[2]" + value(bad), "finite"});
    expect_rollout_refusal(MVN<Eigen::Dynamic>(), {start.q, start.qd}, {"q0[2]" + value(bad)});
    start = paper_start();
    start.qd(3) = bad;
    expect_rollout_refusal(open_fpbm(), {start.q, start.qd}, {"qd0[3]" + value(bad), "finite"});
    // At velocity level, the start velocity is not used.
    EXPECT_EQ(recorded(paper_arm(), paper_circle(), MVN<4>(), start, TimeGrid<>(10.0, 0.1)).result.status, Status::kOk);
  }
}

TEST(BadInput, a_grid_of_another_duration) {
  const State<4> start = paper_start();
  for (const double duration : {5.0, 20.0}) {
    expect_rollout_refusal(open_fpbm(), {start.q, start.qd}, {"grid duration = ", "must be the duration of the path"},
                           duration);
    const State<Eigen::Dynamic> open{start.q, start.qd};
    const TimeGrid<> grid(duration, 0.1);
    int samples = 0;
    const auto record = [&](const auto&) { ++samples; };
    EXPECT_NE(complaint([&] {
                rollout(any_planar_arm(Open::Ones(4)), paper_circle(), erased(open_fpbm()), open, grid, record);
              }),
              "");
    EXPECT_EQ(samples, 0);
  }
}

TEST(BadInput, joints_that_do_not_fit) {
  constexpr int N = Eigen::Dynamic;
  const auto man = MAN<N>();
  const Open four = Open::Constant(4, 0.2);
  const Open three = Open::Constant(3, 0.2);
  const Open five = Open::Constant(5, 0.2);
  for (const Open& wrong : {three, five}) {
    const std::string count = std::to_string(wrong.size());
    expect_rollout_refusal(man, {wrong, four}, {"q0 has " + count + " entries", "must have 4"});
    expect_rollout_refusal(man, {four, wrong}, {"qd0 has " + count + " entries", "must have 4"});

    const DiagonalWeights<N> W(wrong);
    const DenseWeights<N> dense(OpenSquare(wrong.asDiagonal()));
    const auto c = NullSpace<N>{}.with_free_choice(wrong);
    const std::vector<std::string> weights = {"weights has " + count + " entries", "must have 4"};
    const std::vector<std::string> choice = {"c has " + count + " entries", "must have 4"};
    const State<N> start{four, Open::Zero(4)};
    expect_rollout_refusal(WMVN<N>(W), start, weights);
    expect_rollout_refusal(WMVNAcceleration<N>(W), start, weights);
    expect_rollout_refusal(Balanced<N>(0.5, W), start, weights);
    expect_rollout_refusal(FPBM<N>(0.5, W, 1.0, 1.0), start, weights);
    expect_rollout_refusal(FPBM<N>(0.5, dense, 1.0, 1.0), start, weights);
    expect_rollout_refusal(MVN<N>(0.0, c), start, choice);
    expect_rollout_refusal(MAN<N>(c), start, choice);
    expect_rollout_refusal(FPBM<N>(0.5, DiagonalWeights<N>(four), 1.0, 1.0, c), start, choice);
  }
}

}  // namespace
}  // namespace fpbm::test::bad_input_laws
