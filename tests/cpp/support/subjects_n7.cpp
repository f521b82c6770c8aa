#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_n7() {
  return make_subjects<PlanarArm<7>>("n7", 7);
}

}  // namespace fpbm::test
