#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "fpbm/model/tree.hpp"

namespace bench {

/// Pinocchio's dynamics of a robot with a fixed base. Joints that follow others are not coupled.
class DynamicsPeer {
 public:
  /// Model of a URDF file. If only is not empty, the other joints are locked at zero, except joints whose names contain
  /// a word of `only`.
  explicit DynamicsPeer(const std::string& urdf, const std::vector<std::string>& only = {});
  /// Model of a tree.
  explicit DynamicsPeer(const fpbm::Tree<>& tree);
  ~DynamicsPeer();

  /// The tree of the model.
  [[nodiscard]] fpbm::Tree<> tree() const;
  /// Acceleration of gravity in the base frame [m/s²].
  void set_gravity(const Eigen::Vector3d& gravity);

  /// τ by rnea().
  const Eigen::VectorXd& torque(const Eigen::VectorXd& q, const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd);
  /// The upper triangle of M by crba(), in the base frame (Convention::WORLD) or in the frames of the joints.
  const Eigen::MatrixXd& upper_mass_matrix(const Eigen::VectorXd& q, bool in_base = false);
  [[nodiscard]] Eigen::MatrixXd mass_matrix(const Eigen::VectorXd& q);
  [[nodiscard]] Eigen::VectorXd bias(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);
  [[nodiscard]] Eigen::VectorXd gravity_torque(const Eigen::VectorXd& q);
  [[nodiscard]] double kinetic_energy(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);
  /// Energy of the links that joints move.
  [[nodiscard]] double potential_energy(const Eigen::VectorXd& q);

 private:
  struct Model;
  /// Pinocchio's positions: the angle of a continuous joint as cosine and sine.
  const Eigen::VectorXd& positions(const Eigen::VectorXd& q);

  std::unique_ptr<Model> model_;
};

}  // namespace bench
