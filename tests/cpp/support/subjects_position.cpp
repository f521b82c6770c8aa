#include "support/make_subjects.hpp"

namespace fpbm::test {

std::vector<Subject> subjects_position() {
  return make_subjects<SerialArm<7>, Position<3>>("position_n7", 7);
}

}  // namespace fpbm::test
