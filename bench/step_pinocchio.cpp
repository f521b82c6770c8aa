#include "pinocchio_arm.hpp"
#include "step.hpp"
#include "textbook.hpp"

// The schemes in Eigen on Pinocchio's kinematics.
namespace bench {
namespace {

template <typename Case>
class Pinocchio {
 public:
  static constexpr const char* kLibrary = "pinocchio";

  template <bool kWithRate>
  void move(const fpbm::State<Case::kDof>& state, Motion<Case>& motion) {
    constexpr int M = Case::kRows;
    q_ = state.q;
    if constexpr (kWithRate) qd_ = state.qd;
    const PinocchioArm::Motion& found = kWithRate ? arm_.move(q_, qd_) : arm_.move(q_);
    motion.R = found.R;
    motion.p = found.p;
    motion.J = found.J.topRows<M>();
    if constexpr (kWithRate) motion.Jd = found.Jd.topRows<M>();
  }

 private:
  PinocchioArm arm_{Case::Robot::chain()};
  Eigen::VectorXd q_;
  Eigen::VectorXd qd_;
};

template <typename Case, Law law>
using PinocchioAndEigen = Textbook<Pinocchio, Case, law>;

[[maybe_unused]] const bool kAdded = add_library<PinocchioAndEigen>();

}  // namespace
}  // namespace bench
