#include <cstdio>
#include <fpbm/fpbm.hpp>

/// The paper's circle under its scheme; succeeds if the last posture equals the independent solution.
int main() {
  constexpr double kPi = 3.14159265358979323846;
  const fpbm::PlanarArm<4> arm(fpbm::Vector<4>::Ones());
  const fpbm::Path<fpbm::Circle<>> path(fpbm::Circle<>(0.45), 10.0);
  const auto scheme = fpbm::FPBM<4>(0.6, fpbm::Vector<4>(1, 2, 3, 4), 1.0, 1.0);
  const fpbm::State<4> start{{kPi / 12, kPi / 12, kPi / 15, kPi / 15}, fpbm::Vector<4>::Zero()};
  const auto result = fpbm::rollout(arm, path, scheme, start, fpbm::TimeGrid<>(10.0, 1e-3), [](const auto&) {});

  const fpbm::Vector<4> expected(0.215222487, 0.396791734, 0.1144437012, 0.1756873322);
  const double difference = (result.last.q - expected).cwiseAbs().maxCoeff();
  std::printf("%s; %d samples; off by %.1e rad\n", fpbm::message(result.status), result.samples, difference);
  return result.status == fpbm::Status::kOk && difference < 1e-9 ? 0 : 1;
}
