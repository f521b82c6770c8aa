#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> planar_subjects() {
  std::vector<Subject> all;
  const auto add = [&all](const std::vector<Subject>& some) { all.insert(all.end(), some.begin(), some.end()); };
  add(make_subjects<PlanarArm<4>, Position<2>>("n4", 4));
  for (const int dof : {2, 7, 12}) {
    add(make_subjects<PlanarArm<Eigen::Dynamic>, Position<2>>("dynamic_n" + std::to_string(dof), dof));
  }
#ifndef FPBM_FEW_TYPES
  add(make_subjects<PlanarArm<4, float>, Position<2>, Kinds::kDiagonal>("n4_float", 4));
  add(make_subjects<PlanarArm<4>, PlanarPose, Kinds::kDiagonal>("planar_pose_n4", 4));
#endif
  return all;
}

}  // namespace fpbm::test
