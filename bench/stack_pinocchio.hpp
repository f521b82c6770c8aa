#pragma once

#include <Eigen/Core>
#include <memory>

#include "fpbm/model/chain.hpp"

namespace bench {

/// Pinocchio's kinematics of the tip and the elbow of a Panda, in a separate file: the compilation takes minutes.
class StackPinocchio {
 public:
  /// A frame: rows of J and J̇ q̇ along the axes of the base frame, at the origin of the frame, linear rows first.
  struct Frame {
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
    Eigen::Matrix<double, 6, 7> J;
    Eigen::Matrix<double, 6, 1> drift;
  };

  explicit StackPinocchio(const fpbm::Chain<>& chain);
  ~StackPinocchio();

  void move(const Eigen::Matrix<double, 7, 1>& q, const Eigen::Matrix<double, 7, 1>& qd);
  [[nodiscard]] const Frame& tip() const noexcept { return tip_; }
  /// Origin of joint 4.
  [[nodiscard]] const Frame& elbow() const noexcept { return elbow_; }

 private:
  struct Model;
  std::unique_ptr<Model> model_;
  Frame tip_;
  Frame elbow_;
};

}  // namespace bench
