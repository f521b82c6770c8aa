#pragma once

#include <Eigen/Core>
#include <memory>

#include "fpbm/model/chain.hpp"

namespace bench {

/// Pinocchio's kinematics of a chain of revolute joints about z, in a separate file: the compilation takes minutes.
class PinocchioArm {
 public:
  /// Linear rows first, along the axes of the base frame, at the tip.
  struct Motion {
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
    Eigen::Matrix<double, 6, Eigen::Dynamic> J;
    Eigen::Matrix<double, 6, Eigen::Dynamic> Jd;
  };

  explicit PinocchioArm(const fpbm::Chain<>& chain);
  ~PinocchioArm();

  /// Tip and J at q; does not change Jd.
  const Motion& move(const Eigen::VectorXd& q);
  const Motion& move(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);

 private:
  struct Model;
  std::unique_ptr<Model> model_;
  Motion motion_;
};

}  // namespace bench
