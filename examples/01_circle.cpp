// The paper's robot follows the paper's circle (Fig. 2): four unit links, FPBM with α = 0.6 and W = diag(1, 2, 3, 4).

#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  constexpr double kPi = fpbm::kTwoPi / 2.0;
  const fpbm::PlanarArm<4> arm({1.0, 1.0, 1.0, 1.0});  // lengths [m]
  const fpbm::Vector<4> weights{1.0, 2.0, 3.0, 4.0};   // the diagonal of W
  // As in the paper, without null-space damping: the joints still move at the end. Other examples have damping.
  const auto scheme = fpbm::FPBM<4>(0.6, weights, 1.0, 1.0);  // alpha, W, k1, k2
  const fpbm::Path path(fpbm::Circle(0.45), 10.0);            // radius [m], duration [s]
  const fpbm::State<4> start{{kPi / 12, kPi / 12, kPi / 15, kPi / 15}, {0.0, 0.0, 0.0, 0.0}};
  const fpbm::TimeGrid grid(path.duration(), 1e-3);

  double max_error = 0.0;
  const auto run = fpbm::rollout(arm, path, scheme, start, grid, [&](const auto& sample) noexcept {
    max_error = std::max(max_error, sample.error.cwiseAbs().maxCoeff());
  });
  if (run.status != fpbm::Status::kOk) {
    std::printf("stopped at %g s: %s. %s\n", run.time, message(run.status), advice(run.status));
    return 1;
  }

  const auto& qd = run.last.qd;
  std::printf("final joint velocities [rad/s]: %.6f %.6f %.6f %.6f\n", qd(0), qd(1), qd(2), qd(3));
  std::printf("largest tip error [m]: %.1e\n", max_error);
}
