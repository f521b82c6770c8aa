#include <cstdio>
#include <cstring>
#include <fpbm/fpbm.hpp>

/// A program without exceptions: the paper's circle in float. Succeeds if the last posture equals the independent
/// solution. With the argument "bad", the program constructs an invalid arm, and must end there.
int main(int argc, char** argv) {
  using namespace fpbm;
  if (argc > 1 && std::strcmp(argv[1], "bad") == 0) {
    const PlanarArm<2, float> arm(Vector<2, float>(1.0F, -1.0F));
    return 0;
  }
  constexpr float kPi = 3.14159265F;
  const PlanarArm<4, float> arm(Vector<4, float>::Ones());
  const Path<Circle<float>> path(Circle<float>(0.45F), 10.0F);
  const auto scheme = FPBM<4, float>(0.6F, Vector<4, float>(1, 2, 3, 4), 1.0F, 1.0F);
  const State<4, float> start{{kPi / 12, kPi / 12, kPi / 15, kPi / 15}, Vector<4, float>::Zero()};
  const auto result = rollout(arm, path, scheme, start, TimeGrid<float>(10.0F, 1e-2F), [](const auto&) {});

  const Vector<4> expected(0.215222487, 0.396791734, 0.1144437012, 0.1756873322);
  const double difference = (result.last.q.cast<double>() - expected).cwiseAbs().maxCoeff();
  std::printf("%s; off by %.1e rad\n", message(result.status), difference);
  return result.status == Status::kOk && difference < 1e-4 ? 0 : 1;
}
