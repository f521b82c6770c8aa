#include "pinocchio_arm.hpp"

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

namespace bench {

struct PinocchioArm::Model {
  pinocchio::Model model;
  pinocchio::Data data;
  pinocchio::FrameIndex tip;
};

PinocchioArm::PinocchioArm(const fpbm::Chain<>& chain) : model_(std::make_unique<Model>()) {
  pinocchio::Model& model = model_->model;
  pinocchio::JointIndex parent = 0;
  for (const auto& joint : chain.joints) {
    const pinocchio::SE3 placement(joint.placement.R, joint.placement.p);
    parent = model.addJoint(parent, pinocchio::JointModelRZ(), placement, std::to_string(parent + 1));
  }
  const pinocchio::SE3 end(chain.tip.R, chain.tip.p);
  model_->tip = model.addFrame(pinocchio::Frame("tip", parent, 0, end, pinocchio::OP_FRAME));
  model_->data = pinocchio::Data(model);
  motion_.J.setZero(6, model.nv);
  motion_.Jd.setZero(6, model.nv);
}

PinocchioArm::~PinocchioArm() = default;

const PinocchioArm::Motion& PinocchioArm::move(const Eigen::VectorXd& q) {
  auto& [model, data, tip] = *model_;
  pinocchio::computeJointJacobians(model, data, q);
  const pinocchio::SE3& pose = pinocchio::updateFramePlacement(model, data, tip);
  motion_.R = pose.rotation();
  motion_.p = pose.translation();
  pinocchio::getFrameJacobian(model, data, tip, pinocchio::LOCAL_WORLD_ALIGNED, motion_.J);
  return motion_;
}

const PinocchioArm::Motion& PinocchioArm::move(const Eigen::VectorXd& q, const Eigen::VectorXd& qd) {
  auto& [model, data, tip] = *model_;
  pinocchio::computeJointJacobiansTimeVariation(model, data, q, qd);
  const pinocchio::SE3& pose = pinocchio::updateFramePlacement(model, data, tip);
  motion_.R = pose.rotation();
  motion_.p = pose.translation();
  pinocchio::getFrameJacobian(model, data, tip, pinocchio::LOCAL_WORLD_ALIGNED, motion_.J);
  pinocchio::getFrameJacobianTimeVariation(model, data, tip, pinocchio::LOCAL_WORLD_ALIGNED, motion_.Jd);
  return motion_;
}

}  // namespace bench
