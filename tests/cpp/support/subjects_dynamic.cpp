#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_dynamic() {
  return make_subjects<PlanarArm<Eigen::Dynamic>>("dynamic", 12);
}

}  // namespace fpbm::test
