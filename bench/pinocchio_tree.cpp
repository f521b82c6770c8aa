// For forwardKinematics() with accelerations. If a header of Boost is included before this line, the default of Boost,
// which is too low, applies.
#define BOOST_FUSION_INVOKE_MAX_ARITY 10

#include "pinocchio_tree.hpp"

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/multibody/model.hpp>
#include <stdexcept>

namespace bench {
namespace {

/// Adds a joint as Pinocchio's URDF parser does.
pinocchio::JointIndex add_joint(pinocchio::Model& model, const fpbm::TreeJoint<>& given) {
  const auto& joint = given.joint;
  const auto parent = static_cast<pinocchio::JointIndex>(given.parent);
  const pinocchio::SE3 placement(joint.placement.R, joint.placement.p);
  if (joint.axis == Eigen::Vector3d::UnitX())
    return model.addJoint(parent, pinocchio::JointModelRX(), placement, joint.name);
  if (joint.axis == Eigen::Vector3d::UnitY())
    return model.addJoint(parent, pinocchio::JointModelRY(), placement, joint.name);
  if (joint.axis == Eigen::Vector3d::UnitZ())
    return model.addJoint(parent, pinocchio::JointModelRZ(), placement, joint.name);
  throw std::invalid_argument(joint.name + ": its axis must be x, y or z");
}

}  // namespace

struct PinocchioTree::Model {
  pinocchio::Model model;
  pinocchio::Data data;
  std::vector<pinocchio::FrameIndex> frames;
};

PinocchioTree::PinocchioTree(const fpbm::Tree<>& tree) : model_(std::make_unique<Model>()) {
  auto& [model, data, frames] = *model_;
  for (const auto& joint : tree.joints) {
    model.appendBodyToJoint(add_joint(model, joint), pinocchio::Inertia::Identity());
  }
  for (const auto& [name, link, offset] : tree.frames) {
    const pinocchio::SE3 placement(offset.R, offset.p);
    const auto joint = static_cast<pinocchio::JointIndex>(link);
    frames.push_back(model.addFrame(pinocchio::Frame(name, joint, 0, placement, pinocchio::OP_FRAME)));
  }
  data = pinocchio::Data(model);
  at_rest_ = Eigen::VectorXd::Zero(model.nv);
  motions_.resize(frames.size());
  for (Motion& motion : motions_) {
    motion.J.setZero(6, model.nv);
    motion.Jd.setZero(6, model.nv);
  }
}

PinocchioTree::~PinocchioTree() = default;

void PinocchioTree::read_frame(std::size_t i) {
  auto& [model, data, frames] = *model_;
  const pinocchio::SE3& pose = pinocchio::updateFramePlacement(model, data, frames[i]);
  motions_[i].R = pose.rotation();
  motions_[i].p = pose.translation();
  pinocchio::getFrameJacobian(model, data, frames[i], pinocchio::LOCAL_WORLD_ALIGNED, motions_[i].J);
}

const std::vector<PinocchioTree::Motion>& PinocchioTree::move(const Eigen::VectorXd& q) {
  pinocchio::computeJointJacobians(model_->model, model_->data, q);
  for (std::size_t i = 0; i < motions_.size(); ++i) read_frame(i);
  return motions_;
}

const std::vector<PinocchioTree::Motion>& PinocchioTree::move_with_rates(const Eigen::VectorXd& q,
                                                                         const Eigen::VectorXd& qd) {
  auto& [model, data, frames] = *model_;
  pinocchio::computeJointJacobiansTimeVariation(model, data, q, qd);
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    read_frame(i);
    pinocchio::getFrameJacobianTimeVariation(model, data, frames[i], pinocchio::LOCAL_WORLD_ALIGNED, motions_[i].Jd);
  }
  return motions_;
}

const std::vector<PinocchioTree::Motion>& PinocchioTree::move_with_bias(const Eigen::VectorXd& q,
                                                                        const Eigen::VectorXd& qd) {
  auto& [model, data, frames] = *model_;
  pinocchio::forwardKinematics(model, data, q, qd, at_rest_);
  pinocchio::computeJointJacobians(model, data);
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    read_frame(i);
    motions_[i].bias = pinocchio::getFrameClassicalAcceleration(model, data, frames[i], pinocchio::LOCAL_WORLD_ALIGNED);
  }
  return motions_;
}

}  // namespace bench
