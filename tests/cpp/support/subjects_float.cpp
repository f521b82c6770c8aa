#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_float() {
  return make_subjects<PlanarArm<4, float>>("n4_float", 4);
}

}  // namespace fpbm::test
