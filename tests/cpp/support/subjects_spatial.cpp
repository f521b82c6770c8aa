#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> panda_pose_subjects() {
  return make_subjects<SerialArm<7>, Pose, Kinds::kUnitAndDiagonal>("pose_panda", 7, &panda_arm);
}

std::vector<Subject> panda_position_subjects() {
#ifdef FPBM_FEW_TYPES
  return {};
#else
  return make_subjects<SerialArm<7>, Position<3>, Kinds::kDiagonal>("position_panda", 7, &panda_arm);
#endif
}

std::vector<Subject> spatial_subjects() {
  std::vector<Subject> all;
  const auto add = [&all](const std::vector<Subject>& some) { all.insert(all.end(), some.begin(), some.end()); };
  add(make_subjects<SerialArm<7>, Pose, Kinds::kUnitAndDiagonal>("pose_n7", 7));
#ifndef FPBM_FEW_TYPES
  add(make_subjects<SerialArm<7>, Position<3>, Kinds::kDiagonal>("position_n7", 7));
  add(make_subjects<SerialArm<Eigen::Dynamic>, Pose>("pose_on_rail_dynamic_n9", 9));
#endif
  return all;
}

}  // namespace fpbm::test
