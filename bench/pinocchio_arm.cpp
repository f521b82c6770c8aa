#include "pinocchio_arm.hpp"

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "pinocchio_model.hpp"

namespace bench {

struct PinocchioArm::Model {
  pinocchio::Model model;
  pinocchio::Data data;
  pinocchio::FrameIndex tip;
};

PinocchioArm::PinocchioArm(const fpbm::Chain<>& chain) : model_(std::make_unique<Model>()) {
  pinocchio::Model& model = model_->model;
  model = pinocchio_model(chain);
  model_->tip = model.getFrameId("tip");
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
