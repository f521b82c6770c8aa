#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
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

/// Number of motions of each test. FPBM_MOTIONS=5000 gives the numbers of docs/singularities.md.
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

/// What an arm does in the first second, and at last.
struct Motion {
  bool left = false;      ///< Whether the error decreased, or the posture was regular, within a second.
  bool reached = false;   ///< Whether the error fell below 1e-3 within 20 s.
  double time = 0.0;      ///< Until then [s].
  double excess = 0.0;    ///< Largest excess over the bounds on position, velocity, acceleration and jerk, relative.
};

template <typename Space, typename Kind, typename Arm>
[[nodiscard]] Motion moved(Kind kind, const Arm& arm, const Vector<N>& q0, const Reference<Space>& target, double dt,
                           const JointLimits<N>& limits) {
  TrackerOptions<> options;
  options.dt = dt;
  const State<N> start{q0, Vector<N>::Zero(q0.size())};
  CompiledTracker loop(arm, Space{}, scheme_of(kind, arm.dof()), start, options,
                       Limits<Kind::value, N>(limits, dt));
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
      motion.excess =
          std::max({motion.excess, (tick.q(j) - limits.upper(j)) / size, (limits.lower(j) - tick.q(j)) / size,
                    std::abs(tick.qd(j)) / limits.velocity(j) - 1.0,
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
  int motions = 0, left = 0, reached = 0, yardstick = 0;
  double time = 0.0, longest = 0.0, excess = 0.0;
};

template <typename Space, typename Kind, typename Arm>
void count(Kind kind, const std::string& name, const Arm& arm, JointLimits<N> limits, int trials, Count& all) {
  Count of;
  const int kinds = 5;
  for (int k = 0; k < trials; ++k) {
    Random random(static_cast<std::uint32_t>(k));
    const auto q0 = singular_posture<Space>(arm, k % kinds, random);
    if (!q0) continue;
    const auto found = target_of<Space>(arm, *q0, k / kinds % 3, random);
    if (!found) continue;
    const auto target = *found;
    const double dt = std::vector<double>{0.001, 0.004, 0.02}[static_cast<std::size_t>(random.uniform(0.0, 2.999))];
    for (Eigen::Index i = 0; i < arm.dof(); ++i) {
      limits.jerk(i) = k % 2 == 0 ? JointBounds<>::kNone : 50.0 * limits.acceleration(i);
    }
    const Motion motion = moved<Space>(kind, arm, *q0, target, dt, limits);
    if (std::getenv("FPBM_YARDSTICK") != nullptr || std::getenv("FPBM_SHOW") != nullptr) {
      Vector<N> near = *q0;
      for (Eigen::Index i = 0; i < near.size(); ++i) near(i) += near(i) + 1e-3 > limits.upper(i) ? -1e-3 : 1e-3;
      const Motion other = moved<Space>(kind, arm, near, target, dt, limits);
      of.yardstick += other.reached;
      if (std::getenv("FPBM_SHOW") != nullptr && (!motion.left || (!motion.reached && other.reached))) {
        std::printf("  %s rows %d level %d seed %d kind %d target %d dt %g: left %d reached %d (yardstick %d)\n", name.c_str(),
                    Space::kRows, static_cast<int>(Kind::value), k, k % kinds, k / kinds % 3, dt, motion.left, motion.reached,
                    other.reached);
      }
    }
    ++of.motions;
    of.left += motion.left;
    of.reached += motion.reached;
    of.time += motion.time;
    of.longest = std::max(of.longest, motion.time);
    of.excess = std::max(of.excess, motion.excess);
  }
  if (of.motions == 0) return;
  std::printf("%s, %d rows, %s level: %d of %d left within 1 s, %d reached (from q0 + 0.001 rad: %d), mean %.1f s, %.1e\n",
              name.c_str(), Space::kRows, Kind::value == Level::kAcceleration ? "acceleration" : "velocity", of.left,
              of.motions, of.reached, of.yardstick, of.reached > 0 ? of.time / of.reached : 0.0, of.excess);
  all.motions += of.motions;
  all.left += of.left;
  all.reached += of.reached;
  all.yardstick += of.yardstick;
  all.excess = std::max(all.excess, of.excess);
}

template <typename Kind>
void expect_departures(Kind kind) {
  Count all;
  const int each = motions(10);
  for (const presets::Preset& preset : presets::kAll) {
    const auto arm = any_arm(preset.chain());
    count<Pose>(kind, preset.name, arm, arm.limits(), each, all);
    count<Position<3>>(kind, preset.name, arm, arm.limits(), each, all);
  }
  std::printf("all: %d of %d left within 1 s, %d reached (%d)\n", all.left, all.motions, all.reached, all.yardstick);
  EXPECT_EQ(all.left, all.motions);
  EXPECT_LE(all.excess, 1e-9);
}

TEST(SingularStart, is_left_within_a_second_at_acceleration_level) {
  expect_departures(Acceleration{});
}
TEST(SingularStart, is_left_within_a_second_at_velocity_level) {
  expect_departures(Velocity{});
}

}  // namespace
}  // namespace fpbm::test::singular_start_laws
