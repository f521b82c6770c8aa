#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// An arm at rest in a singular posture leaves the posture by itself, if its target is reachable in a lost direction.
namespace fpbm::test::singular_start_laws {
namespace {

constexpr int N = Eigen::Dynamic;

using Acceleration = std::integral_constant<Level, Level::kAcceleration>;
using Velocity = std::integral_constant<Level, Level::kVelocity>;
[[nodiscard]] auto scheme_of(Acceleration, Eigen::Index n) {
  return FPBM<N>(0.6, Vector<N>(Vector<N>::Ones(n)), 10.0, 25.0, NullSpace<N>{}.with_damping(2.0));
}
[[nodiscard]] auto scheme_of(Velocity, Eigen::Index n) {
  return WMVN<N>(Vector<N>(Vector<N>::Ones(n)), 5.0);
}

/// Number of motions of each test. FPBM_MOTIONS=450 gives the numbers of docs/recovery.md.
[[nodiscard]] int motions(int few) {
  const char* given = std::getenv("FPBM_MOTIONS");
  return given != nullptr ? std::atoi(given) : trials(few);
}

/// Smallest singular value of J relative to ‖J‖_F, all rows in metres.
template <typename Space, typename Arm>
[[nodiscard]] double regularity(const Arm& arm, const Vector<N>& q) {
  Kinematics<Space, N> kinematics;
  arm.kinematics(q, kinematics);
  const Eigen::MatrixXd J = jacobian_in_metres(kinematics);
  return J.jacobiSvd().singularValues().minCoeff() / J.norm();
}

[[nodiscard]] Vector<N> random_posture(const JointLimits<N>& bounds, Random& random) {
  Vector<N> q = bounds.lower;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double low = std::max(bounds.lower(i), -2.5);
    const double high = std::min(bounds.upper(i), 2.5);
    q(i) = low + random.uniform(0.1, 0.9) * (high - low);
  }
  return q;
}

/// A posture with some joints at zero: all, the elbow, the wrist, or every second joint and one more joint in the angle
/// of least regularity. Empty if the posture is not singular.
template <typename Space, typename Arm>
[[nodiscard]] std::optional<Vector<N>> singular_posture(const Arm& arm, int kind, Random& random) {
  const JointLimits<N> bounds = arm.limits();
  const Eigen::Index n = arm.dof();
  Vector<N> q = random_posture(bounds, random);
  if (kind == 0) q.setZero();
  if (kind == 1 || kind == 3) q((n - 1) / 2) = 0.0;
  if (kind == 2 || kind == 3) q(n - 2) = 0.0;
  if (kind == 4) {
    for (Eigen::Index i = 0; i < n; i += 2) q(i) = 0.0;
    double best = 1.0;
    Vector<N> at = q;
    for (Eigen::Index i = 1; i < n; i += 2) {
      Vector<N> trial = q;
      for (double step : {1e-2, 1e-4, 1e-6}) {
        const double from = step == 1e-2 ? bounds.lower(i) : at(i) - 100 * step;
        const double to = step == 1e-2 ? bounds.upper(i) : at(i) + 100 * step;
        for (trial(i) = std::max(from, -3.2); trial(i) < std::min(to, 3.2); trial(i) += step) {
          const double value = regularity<Space>(arm, trial);
          if (value < best) best = value, at = trial;
        }
        trial = at;
      }
    }
    q = at;
  }
  const bool within = (q - bounds.lower).minCoeff() >= 0.0 && (bounds.upper - q).minCoeff() >= 0.0;
  if (!within || regularity<Space>(arm, q) > 1e-5) return std::nullopt;
  return q;
}

/// Whether damped Newton steps from postures near q0 find a posture for the target within the limits.
template <typename Space, typename Arm>
[[nodiscard]] bool is_reachable(const Arm& arm, const Vector<N>& q0, const Reference<Space>& target, Random& random) {
  const JointLimits<N> limits = arm.limits();
  for (int start = 0; start < 20; ++start) {
    Vector<N> q = q0 + random.uniform(q0.size(), -0.6, 0.6);
    for (int i = 0; i < 60; ++i) {
      q = q.cwiseMax(limits.lower).cwiseMin(limits.upper).eval();
      Kinematics<Space, N> kinematics;
      arm.kinematics(q, kinematics);
      const Vector<Space::kRows> error = task_error(kinematics, target.x);
      if (error.norm() < 1e-6) return true;
      const Eigen::MatrixXd J = kinematics.J;
      Eigen::MatrixXd gram = J * J.transpose();
      gram.diagonal().array() += 1e-2 * error.squaredNorm() + 1e-8;
      q += J.transpose() * gram.ldlt().solve(error);
    }
  }
  return false;
}

/// A target that is reachable: the tip of a random posture, the tip of a posture near q0, or the tip at q0 with a
/// displacement in the direction of the smallest singular value, which is lost. Empty if the target is not reachable.
template <typename Space, typename Arm>
[[nodiscard]] std::optional<Reference<Space>> target_of(const Arm& arm, const Vector<N>& q0, int kind, Random& random) {
  const JointLimits<N> limits = arm.limits();
  Kinematics<Space, N> kinematics;
  if (kind == 0) {
    arm.kinematics(random_posture(limits, random), kinematics);
    return Reference<Space>::hold(kinematics.tip);
  }
  if (kind == 1) {
    const Vector<N> q = q0 + random.uniform(q0.size(), -0.5, 0.5);
    arm.kinematics(Vector<N>(q.cwiseMax(limits.lower).cwiseMin(limits.upper)), kinematics);
    return Reference<Space>::hold(kinematics.tip);
  }
  arm.kinematics(q0, kinematics);
  const Eigen::MatrixXd J = jacobian_in_metres(kinematics);
  Vector<Space::kRows> by = Eigen::JacobiSVD<Eigen::MatrixXd>(J, Eigen::ComputeFullU).matrixU().col(Space::kRows - 1);
  by *= random.uniform(0.01, 0.15) * (random.uniform(-1.0, 1.0) < 0.0 ? -kinematics.length : kinematics.length);
  for (int i = Space::kRows - Space::kTurns; i < Space::kRows; ++i) by(i) /= kinematics.length;
  const auto target = Reference<Space>::hold(Space::template displace<double>(kinematics.tip, by));
  if (!is_reachable(arm, q0, target, random)) return std::nullopt;
  return target;
}

/// Result of a motion.
struct Motion {
  bool left = false;     ///< Whether the error decreased, or the posture was regular, within a second.
  bool reached = false;  ///< Whether the error fell below 1e-3 within 20 s.
  double time = 0.0;     ///< Until then [s].
  double excess = 0.0;   ///< Largest excess over the bounds on position, velocity, acceleration and jerk, relative.
};

template <typename Space, typename Kind, typename Arm>
[[nodiscard]] Motion moved(Kind kind, const Arm& arm, const Vector<N>& q0, const Reference<Space>& target, double dt,
                           const JointLimits<N>& limits) {
  TrackerOptions<> options;
  options.dt = dt;
  const State<N> start{q0, Vector<N>::Zero(q0.size())};
  CompiledTracker loop(arm, Space{}, scheme_of(kind, arm.dof()), start, options, Limits<Kind::value, N>(limits, dt));
  Kinematics<Space, N> kinematics;
  arm.kinematics(q0, kinematics);
  const double length = kinematics.length;
  Motion motion;
  Vector<N> last = start.qd;
  double initial = 0.0;
  for (int i = 0; i * dt < 20.0; ++i) {
    const auto tick = loop.tick(target);
    const double error = TaskDistance<Space, double>::norm(tick.error, length);
    if (i == 0) initial = error;
    for (Eigen::Index j = 0; j < q0.size(); ++j) {
      const double size = std::isfinite(limits.upper(j)) ? limits.upper(j) - limits.lower(j) : 1.0;
      motion.excess = std::max({motion.excess, (tick.q(j) - limits.upper(j)) / size,
                                (limits.lower(j) - tick.q(j)) / size, std::abs(tick.qd(j)) / limits.velocity(j) - 1.0,
                                std::abs(tick.qdd(j)) / limits.acceleration(j) - 1.0});
      if (std::isfinite(limits.jerk(j))) {
        motion.excess = std::max(motion.excess, std::abs(tick.qdd(j) - last(j)) / (dt * limits.jerk(j)) - 1.0);
      }
    }
    last = tick.qdd;
    if (i * dt < 1.0) motion.left = motion.left || error < 0.99 * initial;
    if (!motion.left && i * dt < 1.0 && i % 5 == 0) motion.left = regularity<Space>(arm, tick.q) > 0.02;
    if (error < 1e-3) {
      motion.reached = motion.left = true;
      motion.time = i * dt;
      break;
    }
  }
  return motion;
}

struct Count {
  int motions = 0;
  int saddles = 0;  ///< Motions whose start is not a local minimum of the error, up to a small curvature.
  int left = 0;     ///< Saddles that the arm left within a second.
  int reached = 0;
  int yardstick = 0;  ///< Targets that are reached from q0 + 0.001 rad. Counted if FPBM_MOTIONS is set.
  double time = 0.0;
  double excess = 0.0;

  void operator+=(const Count& other) {
    motions += other.motions;
    saddles += other.saddles;
    left += other.left;
    reached += other.reached;
    yardstick += other.yardstick;
    time += other.time;
    excess = std::max(excess, other.excess);
  }
};

void print(const std::string& name, const Count& of) {
  std::printf("%s: %d of %d saddle points left within 1 s, %d of %d targets reached in %.1f s on average", name.c_str(),
              of.left, of.saddles, of.reached, of.motions, of.time / std::max(of.reached, 1));
  if (std::getenv("FPBM_MOTIONS") != nullptr) std::printf(" (from q0 + 0.001 rad: %d)", of.yardstick);
  std::printf(", bounds exceeded by %.1e\n", of.excess);
}

/// Whether the error has a direction of negative curvature at q. A curvature of less than 3e-4 of the trace of the
/// Hessian is not counted: the error then decreases by less than 1 % over 0.8 rad.
template <typename Space, typename Arm>
[[nodiscard]] bool is_saddle(const Arm& arm, const Vector<N>& q, const Reference<Space>& target) {
  const Eigen::MatrixXd hessian = error_hessian<Space>(arm, q, target.x);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> pairs(hessian, Eigen::EigenvaluesOnly);
  return pairs.eigenvalues().minCoeff() < -3e-4 * hessian.trace();
}

template <typename Space, typename Kind, typename Arm>
[[nodiscard]] Count count(Kind kind, const Arm& arm, int trials) {
  constexpr int kPostures = 5;
  constexpr int kTargets = 3;
  constexpr double kTicks[] = {0.001, 0.004, 0.02};
  Count of;
  JointLimits<N> limits = arm.limits();
  for (int k = 0; k < trials; ++k) {
    Random random(static_cast<std::uint32_t>(k));
    const auto q0 = singular_posture<Space>(arm, k % kPostures, random);
    if (!q0) continue;
    const auto target = target_of<Space>(arm, *q0, k / kPostures % kTargets, random);
    if (!target) continue;
    const double dt = kTicks[k / 2 % 3];
    for (Eigen::Index i = 0; i < arm.dof(); ++i) {
      limits.jerk(i) = k % 2 == 0 ? JointBounds<>::kNone : 50.0 * limits.acceleration(i);
    }
    const Motion motion = moved<Space>(kind, arm, *q0, *target, dt, limits);
    ++of.motions;
    if (is_saddle<Space>(arm, *q0, *target)) {
      ++of.saddles;
      of.left += motion.left;
      EXPECT_TRUE(motion.left) << "rows " << Space::kRows << ", seed " << k;
    }
    of.reached += motion.reached;
    of.time += motion.time;
    of.excess = std::max(of.excess, motion.excess);
    if (std::getenv("FPBM_MOTIONS") == nullptr) continue;
    Vector<N> near = *q0;
    for (Eigen::Index i = 0; i < near.size(); ++i) near(i) += near(i) + 1e-3 > limits.upper(i) ? -1e-3 : 1e-3;
    of.yardstick += moved<Space>(kind, arm, near, *target, dt, limits).reached;
  }
  return of;
}

template <typename Kind>
void expect_departures(Kind kind) {
  Count all;
  const int each = motions(30);
  for (const presets::Preset& preset : presets::kAll) {
    SCOPED_TRACE(preset.name);
    const auto arm = any_arm(preset.chain());
    const Count poses = count<Pose>(kind, arm, each);
    print(std::string(preset.name) + ", pose", poses);
    all += poses;
    const Count positions = count<Position<3>>(kind, arm, each);
    if (positions.motions > 0) print(std::string(preset.name) + ", position", positions);
    all += positions;
  }
  print("all", all);
  EXPECT_EQ(all.left, all.saddles);
  // The other targets are local minima of the error, far from q0, or beyond limits of joints.
  EXPECT_GE(all.reached, all.motions * 8 / 10);
  EXPECT_LE(all.excess, 1e-9);
}

TEST(SingularStart, is_left_within_a_second_at_acceleration_level) {
  expect_departures(Acceleration{});
}
TEST(SingularStart, is_left_within_a_second_at_velocity_level) {
  expect_departures(Velocity{});
}

template <typename Kind>
void expect_planar_departure(Kind kind) {
  const auto arm = any_planar_arm(Vector<4>::Ones());
  auto limits = JointLimits<N>::none(4);
  for (const Vector<4>& q0 :
       {Vector<4>(0, 0, 0, 0), Vector<4>(0.3, 0, 0, 0), Vector<4>(0.3, 3.14159265358979323846, 0, 0)}) {
    for (const double inward : {0.01, 0.3, 1.0}) {
      for (const double dt : {0.001, 0.004, 0.02}) {
        for (int i = 0; i < 4; ++i) limits.set(i, {-3.2, 3.2, 2.0, 10.0});
        Kinematics<Position<2>, N> kinematics;
        arm.kinematics(Vector<N>(q0), kinematics);
        auto target = Reference<Position<2>>::hold(kinematics.tip);
        target.x *= 1.0 - inward / kinematics.tip.norm();
        const Motion motion = moved<Position<2>>(kind, arm, q0, target, dt, limits);
        EXPECT_TRUE(motion.left && motion.reached) << q0.transpose() << ", inward " << inward << ", dt " << dt;
        EXPECT_LE(motion.excess, 1e-9);
      }
    }
  }
}
TEST(SingularStart, of_four_links_in_line_is_left) {
  expect_planar_departure(Acceleration{});
  expect_planar_departure(Velocity{});
}

/// Starts that are nearly singular. Without the recovery, feedback needs more than the stall time below 1e-6 rad.
template <typename Kind>
void expect_departures_near_zero(Kind kind) {
  const auto arm = any_arm(presets::iiwa14());
  for (const double offset : {0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3}) {
    const Vector<N> q0 = Vector<N>::Constant(7, offset);
    Kinematics<Pose, N> kinematics;
    arm.kinematics(q0, kinematics);
    for (const Vector<3>& by : {Vector<3>(0, 0, -0.2), Vector<3>(0, 0.2, -0.05), Vector<3>(0.1, 0.1, -0.1)}) {
      auto target = Reference<Pose>::hold(kinematics.tip);
      target.x.p += by;
      const Motion motion = moved<Pose>(kind, arm, q0, target, 1e-3, arm.limits());
      EXPECT_TRUE(motion.left && motion.reached) << offset << ", by " << by.transpose();
      EXPECT_LE(motion.time, 6.0) << offset << ", by " << by.transpose();
    }
  }
}
TEST(SingularStart, nearly_singular_is_left) {
  expect_departures_near_zero(Acceleration{});
  expect_departures_near_zero(Velocity{});
}

/// An outstretched arm with an unreachable target is in a local minimum of the error, and stays at rest.
template <typename Kind>
void expect_rest(Kind kind) {
  const auto arm = any_arm(presets::iiwa14());
  for (const double q1 : {0.0, 0.4, 1.2}) {
    Vector<N> q0 = Vector<N>::Zero(7);
    q0(1) = q1;
    Kinematics<Position<3>, N> kinematics;
    arm.kinematics(q0, kinematics);
    const Vector<3> shoulder(0.0, 0.0, 0.36);
    for (const double out : {0.001, 0.1, 2.0}) {
      auto target = Reference<Position<3>>::hold(kinematics.tip);
      target.x += out * (target.x - shoulder).normalized();
      CompiledTracker loop(arm, Position<3>{}, scheme_of(kind, 7), q0);
      for (int i = 0; i < 4000; ++i) {
        const auto tick = loop.tick(target);
        ASSERT_NE(tick.status, Status::kRecovering) << q1 << ' ' << out << ' ' << i;
        ASSERT_LE((tick.q - q0).cwiseAbs().maxCoeff(), 1e-5) << q1 << ' ' << out << ' ' << i;
        if (i == 3999 && out > 0.01) {
          EXPECT_EQ(tick.status, Status::kStalled) << q1 << ' ' << out;
        }
      }
    }
  }
}
TEST(SingularStart, is_kept_while_the_target_is_unreachable) {
  expect_rest(Acceleration{});
  expect_rest(Velocity{});
}

/// stop() ends the motion out of the posture; afterwards the arm reaches its target.
TEST(SingularStart, is_not_left_after_stop) {
  const auto arm = any_arm(presets::iiwa14());
  CompiledTracker loop(arm, Position<3>{}, scheme_of(Acceleration{}, 7), Vector<N>(Vector<N>::Zero(7)));
  auto target = Reference<Position<3>>::hold(loop.tip());
  target.x(2) -= 0.2;
  auto tick = loop.tick(target);
  for (int i = 0; i < 200; ++i) tick = loop.tick(target);
  ASSERT_EQ(tick.status, Status::kRecovering);
  loop.stop();
  for (int i = 0; i < 1000; ++i) tick = loop.tick(target);
  EXPECT_TRUE(tick.qd.isZero(0.0));
  loop.resume();
  for (int i = 0; i < 6000; ++i) tick = loop.tick(target);
  EXPECT_LT(tick.error.norm(), 1e-4);
}

}  // namespace
}  // namespace fpbm::test::singular_start_laws
