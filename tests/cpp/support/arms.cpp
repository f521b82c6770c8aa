#include "support/arms.hpp"

namespace fpbm::test {

Chain<> panda_without_jerk() {
  Chain<> chain = presets::panda();
  for (Joint<>& joint : chain.joints) joint.bounds.jerk = JointBounds<>::kNone;
  return chain;
}

Chain<> panda_on_rail() {
  Chain<> chain = presets::panda();
  Joint<> rail;
  rail.type = JointType::kPrismatic;
  rail.axis = Vector<3>::UnitY();
  rail.bounds = {-1.0, 1.0, 1.0, 5.0};
  chain.joints.insert(chain.joints.begin(), rail);
  return chain;
}

Chain<> coupled_panda() {
  Chain<> chain = panda_on_rail();
  chain.joints.back().mimic = {1, -0.7, 0.3};
  return chain;
}

AnyArm<Position<3>> any_arm(const Chain<>& chain) {
  return make_arm(chain);
}

AnyArm<Position<2>> any_planar_arm(const Vector<Eigen::Dynamic>& lengths) {
  return make_planar_arm(lengths);
}

PlanarArm<4> OwnArm::make_planar() {
  return PlanarArm<4>(Vector<4>(1.0, 0.8, 0.6, 0.4));
}

}  // namespace fpbm::test
