#include <cstdio>
#include <cstring>
#include <fpbm/fpbm.hpp>

/// A program without exceptions: follows a target in float and ends where double does. With the argument "bad" it
/// builds an arm that cannot be, which must not go on.
namespace {

template <typename Scalar>
fpbm::Vector<7> where_it_ends() {
  using namespace fpbm;
  const auto arm = SerialArm<7>(presets::panda()).cast<Scalar>();
  Vector<7> start;
  start << 0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8;
  const Vector<7, Scalar> q0 = start.cast<Scalar>();
  const Vector<7, Scalar> ones = Vector<7, Scalar>::Ones();
  const auto null_space = NullSpace<7, Scalar>().with_damping(Scalar(4)).with_rest_posture(q0, Scalar(4));
  Tracker tracker(arm, Pose{}, FPBM<7, Scalar>(Scalar(0.6), ones, Scalar(10), Scalar(25), null_space), q0);
  auto target = Reference<Pose, Scalar>::hold(tracker.tip());
  target.x.p(0) += Scalar(0.0625);
  for (int i = 0; i < 3000; ++i) tracker.tick(target);
  return tracker.state().q.template cast<double>();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "bad") == 0) {
    const fpbm::PlanarArm<2, float> arm(fpbm::Vector<2, float>(1.0F, -1.0F));
    std::puts("an arm with a negative length");
    return 0;
  }
  const double difference = (where_it_ends<float>() - where_it_ends<double>()).cwiseAbs().maxCoeff();
  std::printf("float ends %.1e rad from double\n", difference);
  return difference < 1e-4 ? 0 : 1;
}
