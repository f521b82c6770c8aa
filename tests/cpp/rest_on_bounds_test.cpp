#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// An arm that starts at rest with a joint exactly on its bound stays there: round-off error neither pushes the joint
/// off the bound nor excites the arm.
namespace fpbm::test::rest_on_bounds_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;

template <typename Scalar>
constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();

template <typename Scalar>
[[nodiscard]] Transform<Scalar> cast(const Transform<>& transform) {
  return {transform.p.cast<Scalar>(), transform.R.cast<Scalar>()};
}

template <typename Scalar>
[[nodiscard]] Chain<Scalar> cast(const Chain<>& chain) {
  Chain<Scalar> result;
  result.tip = cast<Scalar>(chain.tip);
  for (const Joint<>& joint : chain.joints) {
    Joint<Scalar> same;
    same.type = joint.type;
    same.placement = cast<Scalar>(joint.placement);
    same.axis = joint.axis.cast<Scalar>();
    same.bounds = {static_cast<Scalar>(joint.bounds.lower), static_cast<Scalar>(joint.bounds.upper),
                   static_cast<Scalar>(joint.bounds.velocity), static_cast<Scalar>(joint.bounds.acceleration)};
    result.joints.push_back(same);
  }
  return result;
}

/// A posture in the middle of the joint ranges, with one joint on a bound.
template <typename Scalar>
[[nodiscard]] Vector<kOpen, Scalar> posture(const JointLimits<kOpen, Scalar>& bounds, Eigen::Index joint, bool upper) {
  const Vector<kOpen, Scalar> lower = bounds.lower.cwiseMax(Scalar(-3));
  const Vector<kOpen, Scalar> higher = bounds.upper.cwiseMin(Scalar(3));
  Random random(static_cast<std::uint32_t>(joint));
  const Vector<kOpen> share = random.uniform(lower.size(), 0.3, 0.7);
  Vector<kOpen, Scalar> q = lower + share.cast<Scalar>().cwiseProduct(higher - lower);
  q(joint) = upper ? bounds.upper(joint) : bounds.lower(joint);
  return q;
}

/// In double, the arm type whose trackers are compiled for other tests too.
template <typename Scalar>
[[nodiscard]] auto arm_of(const Chain<>& chain) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return any_arm(cast<double>(chain));
  } else {
    return SerialArm<kOpen, Scalar>(cast<Scalar>(chain));
  }
}

template <typename Scalar, typename Arm, typename Scheme>
void expect_to_stay(const Arm& arm, const Scheme& scheme, const Vector<kOpen, Scalar>& q0, Scalar dt) {
  const JointLimits<kOpen, Scalar>& bounds = arm.limits();
  TrackerOptions<Scalar> options;
  options.dt = dt;
  CompiledTracker tracker(arm, Position<3>{}, scheme, q0, options);
  const auto hold = Reference<Position<3>, Scalar>::hold(tracker.tip());
  const Scalar slack = Scalar(4) * kEpsilon<Scalar> * q0.cwiseAbs().maxCoeff();
  // At velocity level, the smallest motion is one digit of q in a tick.
  const Scalar least = Scheme::kLevel == Level::kVelocity ? slack / dt / dt : Scalar(0);
  for (int i = 0; i < trials(200); ++i) {
    const auto tick = tracker.tick(hold);
    ASSERT_TRUE((tick.q.array() <= bounds.upper.array() + slack).all()) << "tick " << i;
    ASSERT_TRUE((tick.q.array() >= bounds.lower.array() - slack).all()) << "tick " << i;
    ASSERT_LE((tick.q - q0).cwiseAbs().maxCoeff(), Scalar(20) * slack) << "tick " << i;
    const Scalar shake = (tick.qdd.cwiseAbs() - Scalar(1e4) * kEpsilon<Scalar> * bounds.acceleration).maxCoeff();
    ASSERT_LE(shake, least) << "tick " << i;
    ASSERT_LE(tick.status, Status::kDamped) << "tick " << i;
  }
}

/// The null-space motion drives one joint against its bound, and moves other joints. The joint stays on its bound.
template <typename Scalar, typename Arm>
void expect_not_to_be_pressed_off(const Arm& arm, const Vector<kOpen, Scalar>& q0, Eigen::Index joint,
                                  Scalar displacement) {
  const Vector<kOpen, Scalar> ones = Vector<kOpen, Scalar>::Ones(q0.size());
  auto beyond = q0;
  beyond(joint) += displacement;
  const auto z = NullSpace<kOpen, Scalar>{}.with_damping(Scalar(4)).with_rest_posture(beyond, Scalar(4));
  CompiledTracker tracker(arm, Position<3>{}, FPBM<kOpen, Scalar>(Scalar(0.6), ones, Scalar(20), Scalar(100), z), q0);
  const auto hold = Reference<Position<3>, Scalar>::hold(tracker.tip());
  const Scalar slack = Scalar(4) * kEpsilon<Scalar> * std::abs(q0(joint));
  for (int i = 0; i < trials(200); ++i) {
    const auto tick = tracker.tick(hold);
    ASSERT_LE(std::abs(tick.q(joint) - q0(joint)), slack) << "tick " << i;
    ASSERT_LE(std::abs(tick.qdd(joint)), Scalar(1e4) * kEpsilon<Scalar> * arm.limits().acceleration(joint)) << i;
    ASSERT_LE(tick.status, Status::kDamped) << "tick " << i;
  }
}

template <typename Scalar>
void expect_every_preset_to_stay() {
  for (const presets::Preset& known : presets::kAll) {
    const auto arm = arm_of<Scalar>(known.chain());
    const Vector<kOpen, Scalar> ones = Vector<kOpen, Scalar>::Ones(arm.dof());
    const auto z = NullSpace<kOpen, Scalar>{}.with_damping(Scalar(2));
    const auto fpbm = FPBM<kOpen, Scalar>(Scalar(0.6), ones, Scalar(20), Scalar(100), z);
    const auto mvn = WMVN<kOpen, Scalar>(ones, Scalar(10));
    for (Eigen::Index joint = 0; joint < arm.dof(); ++joint) {
      for (const bool upper : {false, true}) {
        if (!std::isfinite(arm.limits().upper(joint))) continue;
        const Vector<kOpen, Scalar> q0 = posture<Scalar>(arm.limits(), joint, upper);
        expect_not_to_be_pressed_off<Scalar>(arm, q0, joint, Scalar(upper ? 0.5 : -0.5));
        for (const double dt : {1e-3, 2e-4}) {
          SCOPED_TRACE(::testing::Message() << known.name << ", joint " << joint << (upper ? ", upper" : ", lower")
                                            << " bound, " << sizeof(Scalar) << " bytes, dt " << dt);
          expect_to_stay<Scalar>(arm, fpbm, q0, static_cast<Scalar>(dt));
          expect_to_stay<Scalar>(arm, mvn, q0, static_cast<Scalar>(dt));
        }
      }
    }
  }
}
TEST(RestOnBounds, is_kept_by_every_preset) {
  expect_every_preset_to_stay<double>();
  expect_every_preset_to_stay<float>();
}

}  // namespace
}  // namespace fpbm::test::rest_on_bounds_laws
