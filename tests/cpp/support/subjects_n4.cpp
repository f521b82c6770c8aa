#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_n4() {
  return make_subjects<PlanarArm<4>>("n4", 4);
}

}  // namespace fpbm::test
