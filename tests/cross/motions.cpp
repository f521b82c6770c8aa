#include <cstdio>
#include <cstdlib>
#include <string>

#include "fpbm/fpbm.hpp"

// Prints the last states of motions in hexadecimal, so that the same program on two machines can be compared to the
// last bit (compare.py). A line for each motion: its name, its status, then numbers.
namespace {

using namespace fpbm;

template <typename Numbers>
void print(const std::string& name, Status status, const Numbers& numbers) {
  std::printf("%s %d", name.c_str(), static_cast<int>(status));
  for (const auto number : numbers) std::printf(" %a", static_cast<double>(number));
  std::printf("\n");
}

/// A whole path in one call, without limits.
template <typename Arm, typename Path, typename Scheme>
void roll(const std::string& name, const Arm& arm, const Path& path, const Scheme& scheme,
          const Vector<Arm::kDof, typename Arm::Scalar>& q) {
  using S = typename Arm::Scalar;
  const State<Arm::kDof, S> start{q, Vector<Arm::kDof, S>::Zero()};
  const auto result = rollout(arm, path, scheme, start, TimeGrid<S>(path.duration(), S(1e-3)), [](const auto&) {});
  print("rollout/" + name, result.status, result.last.q);
}

/// A whole path by a tracker, with active limits.
template <typename Space, typename Arm, typename Path, typename Scheme>
void follow(const std::string& name, const Arm& arm, const Path& path, const Scheme& scheme,
            const Vector<Arm::kDof, typename Arm::Scalar>& q) {
  using S = typename Arm::Scalar;
  Tracker tracker(arm, Space{}, scheme, q, TrackerOptions<S>{});
  PathFollower follower(path, tracker.tip());
  Status worst = Status::kOk;
  for (int i = 0; i < 2000; ++i) worst = worse(worst, tracker.tick(follower).status);
  print("tracker/" + name, worst, tracker.state().q);
}

template <typename S>
void planar(const std::string& scalar) {
  using Vector4 = Vector<4, S>;
  const PlanarArm<4, S> arm(Vector4::Ones());
  const Path path(Circle<S>(S(0.45)), S(2));
  const Vector4 q(S(0.26), S(0.26), S(0.21), S(0.21));
  const Vector4 w(1, 2, 3, 4);
  roll("planar/mvn/" + scalar, arm, path, MVN<4, S>(S(1)), q);
  roll("planar/fpbm/" + scalar, arm, path, FPBM<4, S>(S(0.6), w, S(10), S(25)), q);
}

template <typename S>
void panda(const std::string& scalar) {
  const auto arm = SerialArm<7>(presets::panda()).template cast<S>();
  Vector<7, S> q;
  q << S(0), S(-0.3), S(0), S(-2.2), S(0), S(2), S(0.785);
  const auto weights = Vector<7, S>::LinSpaced(S(1), S(7)).eval();
  const auto fpbm = FPBM<7, S>(S(0.6), weights, S(10), S(25), NullSpace<7, S>().with_damping(S(2)));
  const InPlane<Path<Circle<S>>> circle(Path(Circle<S>(S(0.15)), S(2)), {S(0), S(1), S(0)}, {S(0), S(0), S(1)});
  const WithRotation pose(circle, Vector<3, S>(S(0.2), S(0), S(0.3)));
  follow<Pose>("panda/pose/" + scalar, arm, pose, fpbm, q);
  const WithRotation wide(
      InPlane(Path(Circle<S>(S(0.3)), S(1)), Vector<3, S>(S(0), S(1), S(0)), Vector<3, S>(S(0), S(0), S(1))),
      Vector<3, S>(S(0), S(0), S(0)));
  follow<Pose>("panda/pressed/" + scalar, arm, wide, fpbm, q);
}

}  // namespace

int main() {
  planar<double>("double");
  planar<float>("float");
  panda<double>("double");
  panda<float>("float");
  try {
    const PlanarArm<2> arm(Vector<2>(1.0, -1.0));
  } catch (const ParameterError& error) {
    std::printf("refused/%s 0 %d\n", error.name().c_str(), error.index());
  }
  return EXIT_SUCCESS;
}
