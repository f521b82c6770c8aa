// For the visitors of Pinocchio with many arguments. If a header of Boost is included before this line, the default of
// Boost, which is too low, applies.
#define BOOST_FUSION_INVOKE_MAX_ARITY 10

#include "dynamics_peer.hpp"

#include <cmath>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/model.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody/model.hpp>
#include <pinocchio/parsers/urdf.hpp>
#include <vector>

namespace bench {

struct DynamicsPeer::Model {
  pinocchio::Model model;
  pinocchio::Data data;
  Eigen::VectorXd q;
  bool has_pairs = false;  ///< Whether any angle is given as cosine and sine.

  void start() {
    data = pinocchio::Data(model);
    q = pinocchio::neutral(model);
    has_pairs = model.nq != model.nv;
  }
};

DynamicsPeer::DynamicsPeer(const std::string& urdf, const std::vector<std::string>& only)
    : model_(std::make_unique<Model>()) {
  pinocchio::Model& model = model_->model;
  pinocchio::urdf::buildModel(urdf, model);
  const auto is_kept = [&](const std::string& name) {
    for (const std::string& word : only) {
      if (name.find(word) != std::string::npos) return true;
    }
    return only.empty();
  };
  std::vector<pinocchio::JointIndex> locked;
  for (pinocchio::JointIndex i = 1; i < model.joints.size(); ++i) {
    if (!is_kept(model.names[i])) locked.push_back(i);
  }
  if (!locked.empty()) model = pinocchio::buildReducedModel(model, locked, pinocchio::neutral(model));
  model_->start();
}

DynamicsPeer::DynamicsPeer(const fpbm::Tree<>& tree) : model_(std::make_unique<Model>()) {
  pinocchio::Model& model = model_->model;
  for (const auto& [joint, carrier] : tree.joints) {
    const pinocchio::SE3 placement(joint.placement.R, joint.placement.p);
    const Eigen::Vector3d axis = joint.axis.normalized();
    const auto parent = static_cast<pinocchio::JointIndex>(carrier);
    const std::string name = std::to_string(model.joints.size());
    const auto added = joint.type == fpbm::JointType::kPrismatic
                           ? model.addJoint(parent, pinocchio::JointModelPrismaticUnaligned(axis), placement, name)
                           : model.addJoint(parent, pinocchio::JointModelRevoluteUnaligned(axis), placement, name);
    const auto& [mass, centre, inertia] = joint.moved;
    model.appendBodyToJoint(added, pinocchio::Inertia(mass, centre, inertia));
    model.armature(static_cast<Eigen::Index>(added) - 1) = joint.drive.rotor_inertia;
  }
  model_->start();
}

DynamicsPeer::~DynamicsPeer() = default;

fpbm::Tree<> DynamicsPeer::tree() const {
  const pinocchio::Model& model = model_->model;
  pinocchio::Data data(model);
  pinocchio::forwardKinematics(model, data, pinocchio::neutral(model));
  fpbm::Tree<> tree;
  for (pinocchio::JointIndex i = 1; i < model.joints.size(); ++i) {
    fpbm::Joint<> joint;
    const Eigen::Matrix<double, 6, 1> axis = data.joints[i].S().matrix();
    if (axis.head<3>().norm() > 0.5) joint.type = fpbm::JointType::kPrismatic;
    joint.axis = axis.head<3>() + axis.tail<3>();
    joint.placement = {model.jointPlacements[i].translation(), model.jointPlacements[i].rotation()};
    const pinocchio::Inertia& moved = model.inertias[i];
    joint.moved = {moved.mass(), moved.lever(), moved.inertia().matrix()};
    joint.drive.rotor_inertia = model.armature(static_cast<Eigen::Index>(i) - 1);
    joint.name = model.names[i];
    tree.joints.push_back({joint, static_cast<int>(model.parents[i])});
  }
  return tree;
}

void DynamicsPeer::set_gravity(const Eigen::Vector3d& gravity) {
  model_->model.gravity.linear() = gravity;
}

const Eigen::VectorXd& DynamicsPeer::positions(const Eigen::VectorXd& q) {
  const pinocchio::Model& model = model_->model;
  if (!model_->has_pairs) return q;
  for (pinocchio::JointIndex i = 1; i < model.joints.size(); ++i) {
    const double angle = q(model.joints[i].idx_v());
    double* const to = model_->q.data() + model.joints[i].idx_q();
    to[0] = model.joints[i].nq() == 2 ? std::cos(angle) : angle;
    if (model.joints[i].nq() == 2) to[1] = std::sin(angle);
  }
  return model_->q;
}

const Eigen::VectorXd& DynamicsPeer::torque(const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
                                            const Eigen::VectorXd& qdd) {
  return pinocchio::rnea(model_->model, model_->data, positions(q), qd, qdd);
}

const Eigen::MatrixXd& DynamicsPeer::upper_mass_matrix(const Eigen::VectorXd& q, bool in_base) {
  return pinocchio::crba(model_->model, model_->data, positions(q),
                         in_base ? pinocchio::Convention::WORLD : pinocchio::Convention::LOCAL);
}

Eigen::MatrixXd DynamicsPeer::mass_matrix(const Eigen::VectorXd& q) {
  return upper_mass_matrix(q).selfadjointView<Eigen::Upper>();
}

Eigen::VectorXd DynamicsPeer::bias(const Eigen::VectorXd& q, const Eigen::VectorXd& qd) {
  return pinocchio::nonLinearEffects(model_->model, model_->data, positions(q), qd);
}

Eigen::VectorXd DynamicsPeer::gravity_torque(const Eigen::VectorXd& q) {
  return pinocchio::computeGeneralizedGravity(model_->model, model_->data, positions(q));
}

double DynamicsPeer::kinetic_energy(const Eigen::VectorXd& q, const Eigen::VectorXd& qd) {
  // Pinocchio 4.1 omits the rotors of joints with a general axis in the energy, but not in M.
  pinocchio::Model& model = model_->model;
  const Eigen::VectorXd rotors = model.armature;
  model.armature.setZero();
  const double of_links = pinocchio::computeKineticEnergy(model, model_->data, positions(q), qd);
  model.armature = rotors;
  return of_links + 0.5 * rotors.dot(qd.cwiseAbs2());
}

double DynamicsPeer::potential_energy(const Eigen::VectorXd& q) {
  return pinocchio::computePotentialEnergy(model_->model, model_->data, positions(q));
}

}  // namespace bench
