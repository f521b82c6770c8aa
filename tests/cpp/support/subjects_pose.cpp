#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_pose() {
  return make_subjects<SerialArm<7>, Pose>("pose_n7", 7);
}

}  // namespace fpbm::test
