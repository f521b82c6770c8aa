#include "pinocchio_kinematics.hpp"
#include "step.hpp"
#include "textbook.hpp"

// The schemes in Eigen on Pinocchio's kinematics.
namespace bench {
namespace {

template <typename Case, Law law>
using PinocchioAndEigen = Textbook<PinocchioKinematics, Case, law>;

[[maybe_unused]] const bool kAdded = add_library<PinocchioAndEigen>();

}  // namespace
}  // namespace bench
