#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "fpbm/fpbm.hpp"

/// Runs circles for a day at 1 kHz, 8.64e7 ticks, or for a given number of ticks. From the second circle on, the
/// posture at the end of each circle must be the same, to 1e-6 rad. Then runs a tenth of the ticks with a clearance,
/// where a wall cuts off a part of the circle: no pair may be closer than its margin. Prints the largest differences.
namespace {

using namespace fpbm;
constexpr long kTicksPerCircle = 10000;

struct Soaked {
  long circles = 0;
  double drift = 0.0;
  double error = 0.0;
  double nearest = 1e9;  ///< Beyond the margin [m].
  bool failed = false;
};

template <typename Tracker_, typename Path_>
Soaked soak(Tracker_ tracker, const Path_& path, double ticks) {
  Soaked soaked;
  const auto start = tracker.tip();
  auto second = tracker.state().q;
  for (; static_cast<double>(soaked.circles * kTicksPerCircle) < ticks; ++soaked.circles) {
    PathFollower follower(path, start);
    for (long i = 0; i < kTicksPerCircle; ++i) {
      const auto tick = tracker.tick(follower);
      if (failed(tick.status)) {
        std::printf("circle %ld, tick %ld: %s\n", soaked.circles, i, message(tick.status));
        soaked.failed = true;
        return soaked;
      }
      soaked.error = std::fmax(soaked.error, tick.error.norm());
      if constexpr (Tracker_::kBounded) {
        const auto& clearance = tracker.bounds().template get<Clearance<7>>();
        soaked.nearest = std::fmin(soaked.nearest, clearance.nearest_pair(tick.q).second - clearance.margin());
      }
    }
    const auto& q = tracker.state().q;
    if (soaked.circles == 1) second = q;
    if (soaked.circles > 1) soaked.drift = std::fmax(soaked.drift, (q - second).cwiseAbs().maxCoeff());
  }
  return soaked;
}

Soaked soak_planar(double ticks) {
  const Vector<4> q0(0.3, 0.8, -0.5, 0.6);
  const auto z = NullSpace<4>{}.with_damping(2.0).with_rest_posture(q0, 1.0);
  const auto scheme = FPBM<4>(0.6, DiagonalWeights<4>(Vector<4>(1, 2, 3, 4)), 4.0, 4.0, z);
  const Path path(Circle(0.5), kTicksPerCircle * 1e-3);
  return soak(Tracker(PlanarArm<4>(Vector<4>::Ones()), Position<2>{}, scheme, q0), path, ticks);
}

Soaked soak_among_shapes(double ticks) {
  using Shapes = Bounds<Clearance<7>>;
  const auto panda = presets::panda();
  const SerialArm<7> arm(panda);
  const Vector<7> q0{0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854};
  const Vector<7> zero = Vector<7>::Zero();
  const auto z = NullSpace<7>{}.with_damping(4.0).with_rest_posture(q0, 4.0);
  const auto scheme = FPBM<7>(0.6, UnitWeights{}, 20.0, 100.0, z);
  const Obstacle<> wall("wall", HalfSpace<>{{0.0, 0.0, 1.0}, 0.38});
  const Clearance<7> clearance(panda, presets::capsules::panda(), {wall}, 0.01, presets::never_collide::panda());
  const Limits<Level::kAcceleration, 7> limits(arm.limits(), 1e-3);
  const InPlane path(Path(Circle(0.1), kTicksPerCircle * 1e-3), Vector<3>::UnitX(), Vector<3>::UnitZ());
  return soak(Tracker(arm, Position<3>{}, scheme, State<7>{q0, zero}, {}, limits, zero, Shapes(clearance)), path,
              ticks);
}

}  // namespace

int main(int argc, char** argv) {
  const double ticks = argc > 1 ? std::atof(argv[1]) : 8.64e7;
  const Soaked alone = soak_planar(ticks);
  const Soaked shapes = soak_among_shapes(ticks / 10);
  std::printf("%ld circles, %ld ticks: posture at a circle's end constant to %.1e rad, tip error at most %.1e m\n",
              alone.circles, alone.circles * kTicksPerCircle, alone.drift, alone.error);
  std::printf("%ld circles among shapes: no pair nearer than %.1e m beyond its margin, tip error at most %.1e m\n",
              shapes.circles, shapes.nearest, shapes.error);
  const bool kept = !alone.failed && !shapes.failed && alone.drift <= 1e-6;
  return kept && shapes.nearest >= -1e-9 ? EXIT_SUCCESS : EXIT_FAILURE;
}
