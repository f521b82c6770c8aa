#pragma once

#include <Eigen/Core>
#include <memory>

#include "fpbm/model/chain.hpp"

namespace bench {

/// Pinocchio's kinematics of a Panda's tip and elbow, in a separate file, which takes minutes to compile.
class StackPinocchio {
 public:
  /// A frame: rows of J and J̇ q̇ in the base frame's axes at the frame's origin, linear rows first.
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
