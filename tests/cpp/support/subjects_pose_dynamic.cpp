#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_pose_dynamic() {
  return make_subjects<SerialArm<Eigen::Dynamic>, Pose>("pose_on_rail_dynamic_n9", 9);
}

}  // namespace fpbm::test
