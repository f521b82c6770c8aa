// For forwardKinematics() with accelerations. If a header of Boost is included before this line, the default of Boost,
// which is too low, applies.
#define BOOST_FUSION_INVOKE_MAX_ARITY 10

#include "stack_pinocchio.hpp"

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "pinocchio_model.hpp"

namespace bench {

struct StackPinocchio::Model {
  pinocchio::Model model;
  pinocchio::Data data;
  pinocchio::FrameIndex tip;
  pinocchio::FrameIndex elbow;
  Eigen::VectorXd q;
  Eigen::VectorXd qd;
  Eigen::VectorXd qdd;
  pinocchio::Data::Matrix6x tip_J;
  pinocchio::Data::Matrix6x elbow_J;

  /// J: of this frame only, because Pinocchio does not change the columns of the joints after the frame.
  void read(pinocchio::FrameIndex frame, pinocchio::Data::Matrix6x& J, Frame& out) {
    constexpr auto kAxes = pinocchio::LOCAL_WORLD_ALIGNED;
    const pinocchio::SE3& pose = pinocchio::updateFramePlacement(model, data, frame);
    out.R = pose.rotation();
    out.p = pose.translation();
    pinocchio::getFrameJacobian(model, data, frame, kAxes, J);
    out.J = J;
    out.drift = pinocchio::getFrameClassicalAcceleration(model, data, frame, kAxes).toVector();
  }
};

StackPinocchio::StackPinocchio(const fpbm::Chain<>& chain) : model_(std::make_unique<Model>()) {
  pinocchio::Model& model = model_->model;
  model = pinocchio_model(chain);
  model_->elbow = model.addFrame(pinocchio::Frame("elbow", 4, 0, pinocchio::SE3::Identity(), pinocchio::OP_FRAME));
  model_->tip = model.getFrameId("tip");
  model_->data = pinocchio::Data(model);
  model_->q.setZero(model.nq);
  model_->qd.setZero(model.nv);
  model_->qdd.setZero(model.nv);
  model_->tip_J.setZero(6, model.nv);
  model_->elbow_J.setZero(6, model.nv);
}

StackPinocchio::~StackPinocchio() = default;

// J̇ q̇ from accelerations at qdd = 0: faster than J̇ by computeJointJacobiansTimeVariation().
void StackPinocchio::move(const Eigen::Matrix<double, 7, 1>& q, const Eigen::Matrix<double, 7, 1>& qd) {
  Model& m = *model_;
  m.q = q;
  m.qd = qd;
  pinocchio::forwardKinematics(m.model, m.data, m.q, m.qd, m.qdd);
  pinocchio::computeJointJacobians(m.model, m.data);
  m.read(m.tip, m.tip_J, tip_);
  m.read(m.elbow, m.elbow_J, elbow_);
}

}  // namespace bench
