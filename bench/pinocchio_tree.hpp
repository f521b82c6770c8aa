#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "fpbm/model/tree.hpp"

namespace bench {

/// Pinocchio's kinematics of a tree of revolute joints about x, y or z, with J and J̇ of its frames.
class PinocchioTree {
 public:
  /// Linear rows first, along the axes of the base frame, at the origin of the frame.
  struct Motion {
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
    Eigen::Matrix<double, 6, Eigen::Dynamic> J;
    Eigen::Matrix<double, 6, Eigen::Dynamic> Jd;
    Eigen::Matrix<double, 6, 1> bias;  ///< J̇q̇
  };

  /// Throws std::invalid_argument if a joint has another axis.
  explicit PinocchioTree(const fpbm::Tree<>& tree);
  ~PinocchioTree();

  /// Frames and J at q.
  const std::vector<Motion>& move(const Eigen::VectorXd& q);
  /// Frames, J and J̇.
  const std::vector<Motion>& move_with_rates(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);
  /// Frames, J and J̇q̇, from the accelerations of the frames at q̈ = 0.
  const std::vector<Motion>& move_with_bias(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);

 private:
  struct Model;
  void read_frame(std::size_t i);

  std::unique_ptr<Model> model_;
  std::vector<Motion> motions_;
  Eigen::VectorXd at_rest_;  ///< q̈ = 0
};

}  // namespace bench
