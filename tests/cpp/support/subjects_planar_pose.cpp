#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_planar_pose() {
  return make_subjects<PlanarArm<4>, PlanarPose>("planar_pose_n4", 4);
}

}  // namespace fpbm::test
