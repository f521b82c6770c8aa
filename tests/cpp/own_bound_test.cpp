#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/bound/detail/gap_rows.hpp"
#include "fpbm/bound/speed_bounds.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "support/arms.hpp"

/// A bound that is not in the library is one struct, and holds at every tick, alone and joined with another bound.
namespace fpbm::test::own_bound_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using Joints = Vector<kOpen>;

/// Bound q₁ + q₃ ≤ most on two joints that share a cable [rad].
class CableBound {
  using Gaps = GapRows<1, kOpen, kOpen, double, int>;

 public:
  static constexpr int kRows = 1;
  static constexpr Status kStatus = Status::kBlocked;

  CableBound(const AnyArm<Position<3>>& arm, const Chain<>& chain, double most) : robot_(chain), most_(most) {
    g_ = Joints::Zero(arm.dof());
    g_(1) = g_(3) = -1.0;
  }

  [[nodiscard]] static bool empty() noexcept { return false; }
  void require(const Joints& q) const {
    if (!(gap(q) >= 0.0)) validation::reject("q0", ": pulls the cable: must be within the cable's length");
  }
  template <typename Next, typename Rows_>
  void rows(const Next& next, Rows_& rows) noexcept {
    const auto& drives = robot_.drives();
    const GapMotion<kOpen, kOpen, double> motion(drives, next);
    const double now = gap(motion.middle(next.state));
    const double end = now + g_.dot(motion.line);
    gaps_.begin(rows.count);
    gaps_.add({now, Gaps::slack_of(now, g_, DisplacementBound<double>{}, motion), end, 0.0, kNone}, g_, 0, motion,
              rows);
    gaps_.finish(next, motion, rows, [&](int) noexcept { return end; });
  }
  /// The gap is linear in q, so that the bound on the displacement is exact.
  template <typename Limits_, typename Stop_>
  [[nodiscard]] bool accepts(const Limits_&, const State<kOpen>& from, const Stop_& stop) const noexcept {
    const JointDisplacement<kOpen, double> moved(robot_.drives(), stop.displacement);
    return gap(from.q) + std::min(g_.dot(moved.line), 0.0) + moved.least(g_) >= 0.0;
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  [[nodiscard]] double gap(const Joints& q) const noexcept { return most_ + g_.dot(q); }

  Robot<kOpen> robot_;
  double most_;
  Joints g_;
  Gaps gaps_;
};

template <Level kLevel>
[[nodiscard]] auto scheme() {
  if constexpr (kLevel == Level::kVelocity) {
    return MVN<kOpen>(5.0);
  } else {
    return FPBM<kOpen>(0.5, UnitWeights{}, 20.0, 100.0, NullSpace<kOpen>().with_damping(2.0));
  }
}

struct Excess {
  double cable = -1.0;
  double joints = -1.0;
  int blocked = 0;
};

/// Jumping targets for 4 s, from rest, with a stop and a resumption.
template <Level kLevel, typename... More>
[[nodiscard]] Excess pull(double h, double jerk, std::uint32_t seed, const More&... more) {
  const Chain<> chain = presets::panda();
  const AnyArm<Position<3>> arm = any_arm(chain);
  auto bounds = arm.limits();
  bounds.jerk = jerk * bounds.acceleration;
  Random random(seed);
  Joints q = Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  const double most = q(1) + q(3) + random.uniform(0.05, 0.4);
  const CableBound cable(arm, chain, most);
  Tracker tracker(arm, Position<3>{}, scheme<kLevel>(), State<kOpen>{q, 0.0 * q}, TrackerOptions<>{h},
                  Limits<kLevel, kOpen>(bounds, h), Joints(0.0 * q), Bounds(cable, more...));
  auto target = Reference<Position<3>>::hold(tracker.tip());
  const Vector<3> home = target.x;
  Excess excess;
  Joints qd = 0.0 * q;
  for (int k = 0; k * h < 4.0; ++k) {
    if (k % static_cast<int>(std::lround(0.4 / h)) == 0) target.x = home + Vector<3>(random.uniform(3, -0.6, 0.6));
    if (std::abs(k * h - 1.6) < h / 2) tracker.stop();
    if (std::abs(k * h - 2.0) < h / 2) tracker.resume();
    const auto tick = tracker.tick(target);
    excess.blocked += tick.status == Status::kBlocked ? 1 : 0;
    excess.cable = std::max(excess.cable, tick.q(1) + tick.q(3) - most);
    const Joints rate = (tick.q - q) / h;
    const Joints change = (tick.qd - qd) / h;
    excess.joints = std::max({excess.joints, (tick.q - bounds.upper).maxCoeff(), (bounds.lower - tick.q).maxCoeff(),
                              (rate.cwiseAbs() - bounds.velocity).maxCoeff(),
                              h * (change.cwiseAbs() - bounds.acceleration).maxCoeff()});
    q = tick.q;
    qd = tick.qd;
  }
  return excess;
}

template <Level kLevel>
void expect_cable_kept() {
  for (const double h : {1e-3, 4e-3, 2e-2}) {
    for (const double jerk : {std::numeric_limits<double>::infinity(), 100.0, 20.0}) {
      Excess worst;
      for (std::uint32_t seed = 0; seed < 4; ++seed) {
        const Excess alone = pull<kLevel>(h, jerk, seed);
        worst.cable = std::max(worst.cable, alone.cable);
        worst.joints = std::max(worst.joints, alone.joints);
        worst.blocked += alone.blocked;
      }
      EXPECT_LE(worst.cable, 1e-9) << "tick " << h << ", jerk " << jerk;
      EXPECT_GE(worst.cable, -2e-2) << "the bound is reached";
      EXPECT_LE(worst.joints, 1e-9) << "tick " << h << ", jerk " << jerk;
      EXPECT_GT(worst.blocked, 0);
    }
  }
}
TEST(OwnBound, is_kept_at_every_tick) {
  expect_cable_kept<Level::kAcceleration>();
  expect_cable_kept<Level::kVelocity>();
}

TEST(OwnBound, is_kept_beside_another_bound) {
  SpeedBounds<kOpen> slow(presets::panda());
  slow.keep({{Robot<kOpen>::kTip}, 0.3});
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    const Excess joined = pull<Level::kAcceleration>(1e-3, 100.0, seed, slow);
    EXPECT_LE(joined.cable, 1e-9);
    EXPECT_LE(joined.joints, 1e-9);
  }
}

TEST(OwnBound, rejects_a_start_beyond_the_bound) {
  const Chain<> chain = presets::panda();
  const CableBound cable(any_arm(chain), chain, -3.0);
  EXPECT_EQ(complaint([&] {
              cable.require(Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785});
            }),
            "q0: pulls the cable: must be within the cable's length");
}

}  // namespace
}  // namespace fpbm::test::own_bound_laws
