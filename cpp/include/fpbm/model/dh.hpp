#pragma once

#include <vector>

#include "fpbm/geometry/detail/sincos.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/chain.hpp"

namespace fpbm {

/// One row of a table of Denavit-Hartenberg parameters. The joint position is added to theta, or to d if the joint is
/// prismatic.
template <typename Scalar = double>
struct DHRow {
  Scalar a = 0;      ///< [m], along x.
  Scalar alpha = 0;  ///< [rad], about x.
  Scalar d = 0;      ///< [m], along z.
  Scalar theta = 0;  ///< [rad], about z.
  JointType type = JointType::kRevolute;
};

namespace dh {

/// Tx(a) Rx(alpha), which commute.
template <typename Scalar>
[[nodiscard]] Transform<Scalar> along_x(const DHRow<Scalar>& row) noexcept {
  return {{row.a, Scalar(0), Scalar(0)}, rotation(Vector<3, Scalar>(row.alpha, Scalar(0), Scalar(0)))};
}

/// Tz(d) Rz(theta), which commute with each other and with the joint motion.
template <typename Scalar>
[[nodiscard]] Transform<Scalar> along_z(const DHRow<Scalar>& row) noexcept {
  return {{Scalar(0), Scalar(0), row.d}, rotation(Vector<3, Scalar>(Scalar(0), Scalar(0), row.theta))};
}

}  // namespace dh

/// Chain, from base to tip, of a table of classic Denavit-Hartenberg parameters, in which the pose of frame i in frame
/// i − 1 is
///   Rz(theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i)
/// (J. Denavit, R. S. Hartenberg, 1955). The tip is the last frame.
template <typename Scalar>
[[nodiscard]] Chain<Scalar> classic_dh(const std::vector<DHRow<Scalar>>& table) {
  Chain<Scalar> chain;
  for (const DHRow<Scalar>& row : table) {
    chain.joints.push_back({row.type, chain.tip});
    chain.tip = dh::along_z(row) * dh::along_x(row);
  }
  return chain;
}

/// Chain, from base to tip, of a table of modified Denavit-Hartenberg parameters, in which the pose of frame i in frame
/// i − 1 is
///   Rx(alpha_i) Tx(a_i) Rz(theta_i) Tz(d_i);
/// a and alpha belong to the link before joint i, which some tables number i − 1 (J. J. Craig, Introduction to
/// Robotics). The tip is the frame of the last joint.
template <typename Scalar>
[[nodiscard]] Chain<Scalar> modified_dh(const std::vector<DHRow<Scalar>>& table) {
  Chain<Scalar> chain;
  for (const DHRow<Scalar>& row : table) {
    chain.joints.push_back({row.type, dh::along_x(row) * dh::along_z(row)});
  }
  return chain;
}

}  // namespace fpbm
