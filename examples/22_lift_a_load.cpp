// A Panda lifts 3 kg from the floor and carries the load past its base, at the edge of its torques.

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

namespace {

const fpbm::Chain<> kChain = fpbm::presets::panda();
const fpbm::SerialArm<7> kArm(kChain);

/// Moves the load within bounds, and prints the duration of the motion, its largest torque and the error of the tip.
template <typename Bounds>
bool lift(const char* name, fpbm::Dynamics<7> dynamics, Bounds bounds) {
  const fpbm::Vector<7> q0{-0.319, 0.894, -0.141, -1.463, 0.154, 2.345, -0.516};  // [rad], far from the base
  const fpbm::Vector<7> rest = fpbm::Vector<7>::Zero();
  const fpbm::Polyline<fpbm::Position<3>> line({{0.0, 0.0, 0.0}, {0.0, 0.0, 0.3}, {0.0, 0.6, 0.3}}, 0.1);  // [m]
  const fpbm::WithRotation path(fpbm::Path(line, 1.0, fpbm::Quintic{}));  // [s], a lower bound
  const auto scheme = fpbm::FPBM<7>(0.6, fpbm::UnitWeights{}, 40.0, 400.0, fpbm::NullSpace<7>().with_damping(10.0));
  fpbm::TrackerOptions<> options;  // 1 kHz
  options.singular = fpbm::SingularDamping<>::off();
  const fpbm::Limits<fpbm::Level::kAcceleration, 7> limits(kArm.limits(), options.dt);
  fpbm::Tracker tracker(kArm, fpbm::Pose{}, scheme, fpbm::State<7>{q0, rest}, options, limits, rest, bounds);
  fpbm::FastestOptions planning;
  planning.reserve = 0.05;
  const auto kept = fpbm::kept_path(kArm, path, tracker.scheme(), q0, kArm.limits(), bounds, planning);
  fpbm::PathFollower follower(kept, tracker.tip());

  int ticks = 0;
  double share = 0.0;
  double error = 0.0;
  fpbm::Status status = fpbm::Status::kOk;
  fpbm::Dynamics<7>::State state;
  while (!follower.done() && !fpbm::failed(status)) {
    dynamics.robot().update(tracker.state().q, tracker.state().qd, state);
    const auto tick = tracker.tick(follower);
    const fpbm::Vector<7> torque = dynamics.inverse_dynamics(state, tick.qdd);
    ++ticks;
    share = std::max(share, torque.cwiseQuotient(kArm.limits().effort).cwiseAbs().maxCoeff());
    error = std::max(error, tick.error.template head<3>().norm());
    status = tick.status;
  }
  std::printf("%s: %.3f s, largest torque %.3f of the effort, %.0e m from the path\n", name, 1e-3 * ticks, share,
              error);
  return !fpbm::failed(status);
}

}  // namespace

int main() {
  fpbm::Dynamics<7> dynamics(kChain);
  if (!dynamics.set_payload(fpbm::Robot<7>::kTip, {3.0, {0.0, 0.0, 0.15}})) return 1;  // 0.15 m in front of the flange
  const fpbm::Vector<7>& effort = kArm.limits().effort;
  const bool done =
      lift("no bounds", dynamics, fpbm::Bounds<>()) &&
      lift("bounds", dynamics, fpbm::Bounds(fpbm::TorqueBounds<7>(kChain, dynamics, effort))) &&
      lift("90 % of the bounds", dynamics, fpbm::Bounds(fpbm::TorqueBounds<7>(kChain, dynamics, 0.9 * effort)));
  return done ? 0 : 1;
}
