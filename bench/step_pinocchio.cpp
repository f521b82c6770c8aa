#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "step.hpp"
#include "textbook.hpp"

// The schemes in Eigen on Pinocchio's kinematics.

namespace bench {
namespace {

template <typename Case>
class Pinocchio {
 public:
  static constexpr const char* kLibrary = "pinocchio";

  Pinocchio() {
    const fpbm::Chain<> chain = Case::Robot::chain();
    pinocchio::JointIndex parent = 0;
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const auto& [R, p] = chain.joints[i].placement;
      parent = model_.addJoint(parent, pinocchio::JointModelRZ(), pinocchio::SE3(R, p), std::to_string(i));
    }
    tip_ = model_.addFrame(pinocchio::Frame("tip", parent, 0, {chain.tip.R, chain.tip.p}, pinocchio::OP_FRAME));
    data_ = pinocchio::Data(model_);
  }

  template <bool kWithRate>
  void move(const fpbm::State<Case::kDof>& state, Motion<Case>& motion) {
    constexpr int M = Case::kRows;
    q_ = state.q;
    if constexpr (kWithRate) {
      qd_ = state.qd;
      pinocchio::computeJointJacobiansTimeVariation(model_, data_, q_, qd_);
    } else {
      pinocchio::computeJointJacobians(model_, data_, q_);
    }
    const pinocchio::SE3& tip = pinocchio::updateFramePlacement(model_, data_, tip_);
    pinocchio::getFrameJacobian(model_, data_, tip_, pinocchio::LOCAL_WORLD_ALIGNED, J_);
    motion.R = tip.rotation();
    motion.p = tip.translation();
    motion.J = J_.template topRows<M>();
    if constexpr (kWithRate) {
      pinocchio::getFrameJacobianTimeVariation(model_, data_, tip_, pinocchio::LOCAL_WORLD_ALIGNED, Jd_);
      motion.Jd = Jd_.template topRows<M>();
    }
  }

 private:
  pinocchio::Model model_;
  pinocchio::Data data_;
  pinocchio::FrameIndex tip_;
  Eigen::VectorXd q_ = Eigen::VectorXd::Zero(Case::kDof);
  Eigen::VectorXd qd_ = Eigen::VectorXd::Zero(Case::kDof);
  pinocchio::Data::Matrix6x J_ = pinocchio::Data::Matrix6x::Zero(6, Case::kDof);
  pinocchio::Data::Matrix6x Jd_ = pinocchio::Data::Matrix6x::Zero(6, Case::kDof);
};

template <typename Case, Law law>
using PinocchioAndEigen = Textbook<Pinocchio, Case, law>;

[[maybe_unused]] const bool kAdded = add_library<PinocchioAndEigen>();

}  // namespace
}  // namespace bench
