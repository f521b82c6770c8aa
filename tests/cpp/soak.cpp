#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "fpbm/fpbm.hpp"

/// Circles for a day at 1 kHz, 8.64e7 ticks, or for the number of ticks given. From the second circle on the posture at
/// the end of each must be the same, to 1e-6 rad. Prints the largest difference.
int main(int argc, char** argv) {
  using namespace fpbm;
  constexpr long kTicksPerCircle = 10000;
  const double ticks = argc > 1 ? std::atof(argv[1]) : 8.64e7;

  const Vector<4> q0(0.3, 0.8, -0.5, 0.6);
  const auto z = NullSpace<4>{}.with_damping(2.0).with_rest_posture(q0, 1.0);
  const auto scheme = FPBM<4>(0.6, DiagonalWeights<4>(Vector<4>(1, 2, 3, 4)), 4.0, 4.0, z);
  Tracker tracker(PlanarArm<4>(Vector<4>::Ones()), Position<2>{}, scheme, q0);
  const Path path(Circle(0.5), kTicksPerCircle * 1e-3);
  const auto start = tracker.tip();

  Vector<4> second = q0;
  double drift = 0.0;
  double error = 0.0;
  long circles = 0;
  for (; static_cast<double>(circles * kTicksPerCircle) < ticks; ++circles) {
    PathFollower follower(path, start);
    for (long i = 0; i < kTicksPerCircle; ++i) {
      const auto tick = tracker.tick(follower);
      if (failed(tick.status)) {
        std::printf("circle %ld, tick %ld: %s\n", circles, i, message(tick.status));
        return EXIT_FAILURE;
      }
      error = std::fmax(error, tick.error.norm());
    }
    if (circles == 1) second = tracker.state().q;
    if (circles > 1) drift = std::fmax(drift, (tracker.state().q - second).cwiseAbs().maxCoeff());
  }
  std::printf("%ld circles, %ld ticks: posture at a circle's end constant to %.1e rad, tip error at most %.1e m\n",
              circles, circles * kTicksPerCircle, drift, error);
  return drift <= 1e-6 ? EXIT_SUCCESS : EXIT_FAILURE;
}
