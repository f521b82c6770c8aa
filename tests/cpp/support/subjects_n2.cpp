#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_n2() {
  return make_subjects<PlanarArm<2>>("n2", 2);
}

}  // namespace fpbm::test
