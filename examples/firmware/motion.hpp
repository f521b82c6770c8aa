#pragma once

#include <fpbm/bound/torque_bounds.hpp>
#include <fpbm/model/serial_arm.hpp>
#include <fpbm/path/path_follower.hpp>
#include <fpbm/path/placed.hpp>
#include <fpbm/path/shapes.hpp>
#include <fpbm/realtime/tracker.hpp>
#include <fpbm/scheme/schemes.hpp>

#include "panda.hpp"
#include "ur5e.hpp"

/// The motions of the board, also computed on a PC: circles at 1 kHz in float, within the joint limits, and within
/// bounds on torque.
namespace firmware {

constexpr int kTicks = 10000;

/// An arm with a tip that draws a circle with constant orientation: one tick for each call.
template <int N, typename Bounds = fpbm::Bounds<>>
class Motion {
 public:
  static constexpr int kDof = N;
  using Joints = fpbm::Vector<N, float>;

  /// seconds: duration of a circle [s].
  Motion(const fpbm::SerialArm<N, float>& arm, const Joints& q0, float radius, float seconds, const Bounds& bounds = {})
      : tracker_(arm, fpbm::Pose{}, scheme(q0), {q0, Joints::Zero()}, options(), {arm.limits(), options().dt},
                 Joints::Zero(), bounds),
        follower_(path(radius, seconds), tracker_.tip()) {}

  fpbm::Tick<fpbm::Pose, N, float> tick() { return tracker_.tick(follower_); }

  [[nodiscard]] const Joints& q() const { return tracker_.state().q; }

 private:
  using Scheme = fpbm::AccelerationScheme<N, float>;
  using Path = fpbm::WithRotation<fpbm::InPlane<fpbm::Path<fpbm::Circle<float>, fpbm::Quintic>>>;

  static Scheme scheme(const Joints& rest) {
    const auto homeward = fpbm::NullSpace<N, float>().with_damping(4.0F).with_rest_posture(rest, 4.0F);
    return fpbm::FPBM<N, float>(0.6F, Joints::LinSpaced(8.0F, 1.0F), 20.0F, 100.0F, homeward);
  }

  static fpbm::TrackerOptions<float> options() {
    fpbm::TrackerOptions<float> options;
    options.recovery = false;  // A recovery stores postures, at 29,000 instructions in one tick.
    return options;
  }

  static Path path(float radius, float seconds) {
    const fpbm::Path circle(fpbm::Circle<float>(radius), seconds, fpbm::Quintic{});
    return Path(fpbm::InPlane(circle, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}));
  }

  fpbm::Tracker<fpbm::SerialArm<N, float>, fpbm::Pose, Scheme, Bounds> tracker_;
  fpbm::PathFollower<Path> follower_;
};

inline const fpbm::Vector<7, float> kPandaStart{0.0F, -0.3F, 0.0F, -2.2F, 0.0F, 2.0F, 0.785F};

inline Motion<7> panda_motion(float radius, float seconds) {
  return {panda::arm(), kPandaStart, radius, seconds};
}

using TorqueBounds = fpbm::Bounds<fpbm::TorqueBounds<7, float>>;

/// With a payload [kg] at the flange, and torques of at most a fraction of the efforts.
inline Motion<7, TorqueBounds> panda_motion(float radius, float seconds, float payload, float fraction) {
  const fpbm::Chain<float, 7> chain = panda::chain();
  const fpbm::SerialArm<7, float> arm(chain);
  fpbm::Dynamics<7, float> dynamics(chain);
  dynamics.set_payload(fpbm::Robot<7, float>::kTip, {payload, {0.0F, 0.0F, 0.1F}});
  const TorqueBounds bounds(fpbm::TorqueBounds<7, float>(chain, dynamics, fraction * arm.limits().effort));
  return {arm, kPandaStart, radius, seconds, bounds};
}

inline Motion<6> ur5e_motion(float radius, float seconds) {
  return {ur5e::arm(), {0.0F, -1.5F, 1.8F, -0.4F, 1.5F, 0.0F}, radius, seconds};
}

/// Both arms on slow circles within the limits, then on wide and fast circles on which joints meet their limits. Then
/// a Panda with 1.5 kg and 60 % of its efforts: a circle within the bounds on torque, and a circle that needs more.
struct Motions {
  Motion<7> panda = panda_motion(0.1F, 10.0F);
  Motion<6> ur5e = ur5e_motion(0.1F, 10.0F);
  Motion<7> panda_pressed = panda_motion(0.25F, 2.0F);
  Motion<6> ur5e_pressed = ur5e_motion(0.25F, 2.0F);
  Motion<7, TorqueBounds> panda_torques = panda_motion(0.21F, 3.0F, 1.5F, 0.6F);
  Motion<7, TorqueBounds> panda_torques_pressed = panda_motion(0.23F, 3.0F, 1.5F, 0.6F);
};

}  // namespace firmware
