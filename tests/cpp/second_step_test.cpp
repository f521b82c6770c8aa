#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fpbm/fpbm.hpp"
#include "support/arms.hpp"
#include "support/linear_program.hpp"
#include "support/random.hpp"

/// The second step of limits with bounds on jerk, and its degenerate problems: the start motion is on bounds, and its
/// goal may be on the same bounds. The task scale equals the result of a linear program.
namespace fpbm::test::second_step_laws {
namespace {

/// Slack of the bounds in the linear program, in their own units: the round-off error of the bound of an envelope.
constexpr double kSlack = 1e-12;

/// Number of problems for each type of arm and task. FPBM_SECOND_STEPS sets another number: 12 × 8334 are 100,000.
[[nodiscard]] int problems_of_each_kind() {
  const char* number = std::getenv("FPBM_SECOND_STEPS");
  return number != nullptr ? std::atoi(number) : trials(600);
}

struct Tally {
  std::string name;
  int all = 0;
  int below = 0;    ///< Number of scales below the optimum by more than 1e-6.
  int frozen = 0;   ///< Number with s = 0, although the optimum is larger.
  int blocked = 0;  ///< Number with s = 0.
  double worst = 0.0;

  void add(double scale, double most) {
    ++all;
    worst = std::max(worst, most - scale);
    if (scale < most - 1e-6) ++below;
    if (scale < 1e-9 && most > 1e-6) ++frozen;
    if (scale < 1e-9) ++blocked;
  }
  void expect_optimal() const {
    std::printf(
        "%s: %d problems, %d below the linear program by more than 1e-6 (worst %.1e), %d of them at 0; %d at 0\n",
        name.c_str(), all, below, worst, frozen, blocked);
    EXPECT_EQ(below, 0) << name;
  }
};

/// Random gains of damped weighted least squares with feedback, which compile faster than the schemes of two levels.
struct Law {
  Eigen::VectorXd inverse_weights;
  double k1;
  double k2;
  double null_damping;

  explicit Law(Random& random)
      : inverse_weights(random.uniform(7, 0.2, 5.0).cwiseInverse()),
        k1(random.uniform(5.0, 20.0)),
        k2(random.uniform(10.0, 100.0)),
        null_damping(random.uniform(0.0, 4.0)) {}

  /// The motion nearest to a null-space motion with J u = task.
  [[nodiscard]] Eigen::VectorXd motion(const Eigen::MatrixXd& J, const Eigen::VectorXd& task,
                                       const Eigen::VectorXd& near) const {
    const Eigen::MatrixXd weighted_transpose = inverse_weights.asDiagonal() * J.transpose();
    const Eigen::MatrixXd gram = J * weighted_transpose + 4e-4 * Eigen::MatrixXd::Identity(J.rows(), J.rows());
    return near + weighted_transpose * gram.llt().solve(task - J * near);
  }
};

/// The goal of the second step, as determined by the first step; s of both steps.
template <Level kLevel, int M>
struct SecondStep {
  Box<7> box;
  Vector<7> from;
  Vector<7> goal;
  double first;

  SecondStep(const Limits<kLevel, 7>& limits, const Matrix<M, 7>& J, const State<7>& state, const Vector<7>& last,
             const Vector<7>& desired)
      : box(limits.box(state, last)) {
    const Box<7> in_time = box_in_time(limits, state, last, box);
    NullSpaceSaturation<M, 7, double> saturation(J, limits.bounds().acceleration);
    const auto found = in_time.contains(desired)
                           ? SaturatedMotion<7>{desired, 1.0, 0, 0}
                           : saturation(in_time, brake_in_proportion(limits, state, in_time), desired);
    first = found.scale;
    goal = found.u;
    from = last;
    if constexpr (kLevel == Level::kVelocity) {
      from = state.qd + limits.tick() * last;
      double share = 1.0;
      for (int i = 0; i < 7; ++i) {
        const double change = std::abs(goal(i) - state.qd(i));
        share = std::min(share, limits.tick() * limits.jerk_limited(i).change(change) / change);
      }
      goal = state.qd + share * (goal - state.qd);
    }
    from = box.nearest(from);
  }
};

/// Circles that exceed the limits, until the given number of second steps has occurred.
template <typename Space, Level kLevel>
void check_motions(const std::string& name, const Chain<>& chain, double jerk_per_acceleration) {
  constexpr int M = Space::kRows;
  constexpr double kTick = 1e-3;
  const SerialArm<7> arm(chain);
  JointLimits<7> bounds = arm.limits();
  if (jerk_per_acceleration > 0.0) bounds.jerk = jerk_per_acceleration * bounds.acceleration;
  const Limits<kLevel, 7> limits(bounds, kTick);
  const Limiter<kLevel, 7> limiter(limits);
  Tally tally{name + (kLevel == Level::kVelocity ? ", velocity" : ", acceleration")};
  const Vector<7> upper = bounds.upper.cwiseMin(3.0);
  const Vector<7> lower = bounds.lower.cwiseMax(-3.0);
  const int most = problems_of_each_kind();
  for (std::uint32_t seed = 0; tally.all < most; ++seed) {
    Random random(seed);
    const Law law(random);
    State<7> state{lower + (upper - lower).cwiseProduct(Vector<7>(random.uniform(7, 0.1, 0.9))), Vector<7>::Zero()};
    Vector<7> last = Vector<7>::Zero();
    Kinematics<Space, 7> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    const InPlane circle(Path(Circle<>(random.uniform(0.02, 0.3)), random.uniform(0.5, 4.0)), Vector<3>(0, 1, 0),
                         Vector<3>(0, 0, 1));
    const auto path = [&] {
      if constexpr (M == 6)
        return WithRotation(circle, Vector<3>(random.uniform(3, -1.0, 1.0)));
      else
        return circle;
    }();
    PathFollower follower(path, kinematics.tip);
    for (int k = 0; k < 3000 && tally.all < most; ++k) {
      arm.kinematics(state.q, state.qd, kinematics);
      const Reference<Space> reference = follower.ahead(0.0);
      follower.advance(kTick);
      const Vector<M> error = Space::template difference<double>(reference.x, kinematics.tip);
      Vector<M> task = reference.xd + law.k1 * error;
      Vector<7> near = Vector<7>::Zero();
      if constexpr (kLevel == Level::kAcceleration) {
        const Vector<M> velocity = kinematics.J * state.qd;
        task = reference.xdd + law.k1 * (reference.xd - velocity) + law.k2 * error - kinematics.Jd * state.qd;
        near = -law.null_damping * state.qd;
      }
      const Vector<7> desired = law.motion(kinematics.J, task, near);
      const Matrix<M, 7> J = jacobian_in_metres(kinematics);
      const SaturatedMotion<7> motion = limiter.motion(J, state, desired, last);
      const SecondStep<kLevel, M> step(limits, J, state, last, desired);
      const Eigen::MatrixXd gram = J * J.transpose();
      const double singular = gram.llt().solve(Eigen::MatrixXd::Identity(M, M)).trace();  // Σ 1/σ²
      if (!step.box.contains(desired) && !step.box.contains(step.goal) && step.first >= 0.1 && singular < M * 1e6) {
        const auto optimum = [&](double slack) {
          const Vector<7> wider = Vector<7>::Constant(kLevel == Level::kVelocity ? kTick * slack : slack);
          return largest_scale(J, step.box.lower - wider, step.box.upper + wider, step.from, step.goal, {}, {});
        };
        double best = optimum(kSlack);
        // Extrapolates the optimum linearly to zero slack. Since the optimum is concave in the slack, the result is at
        // least the optimum without slack.
        if (motion.scale / step.first < best - 1e-6) best = 2.0 * optimum(kSlack / 2.0) - best;
        tally.add(motion.scale / step.first, best);
      }
      const Vector<7> next = kLevel == Level::kVelocity ? motion.u : Vector<7>(state.qd + kTick * motion.u);
      last = (next - state.qd) / kTick;
      state.q += kTick * (kLevel == Level::kVelocity ? next : Vector<7>((state.qd + next) / 2.0));
      state.qd = next;
    }
  }
  tally.expect_optimal();
}

template <typename Space, Level kLevel>
void check_arms(const std::string& task) {
  check_motions<Space, kLevel>("FR3 " + task, presets::fr3(), 0.0);
  check_motions<Space, kLevel>("Panda " + task, presets::panda(), 0.0);
  check_motions<Space, kLevel>("iiwa14 " + task, presets::iiwa14(), 200.0);
}

TEST(SecondStep, is_optimal_along_motions_by_acceleration) {
  check_arms<Pose, Level::kAcceleration>("pose");
  check_arms<Position<3>, Level::kAcceleration>("position");
}
TEST(SecondStep, is_optimal_along_motions_by_velocity) {
  check_arms<Pose, Level::kVelocity>("pose");
  check_arms<Position<3>, Level::kVelocity>("position");
}

}  // namespace
}  // namespace fpbm::test::second_step_laws
