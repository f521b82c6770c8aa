#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/linalg/detail/three.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Joints from base to tip. An arm is built from a chain. If Length is known at compile time, there is no heap
/// allocation.
template <typename Scalar = double, int Length = Eigen::Dynamic>
struct Chain {
  std::array<Joint<Scalar, std::string_view>, Length> joints = {};
  Transform<Scalar> tip = {};  ///< Frame of the tip in the frame of the last joint.

  /// Conversion to a chain whose length is known at run time.
  operator Chain<Scalar>() const {
    Chain<Scalar> chain{{}, tip};
    for (const auto& [type, placement, axis, bounds, name, mimic, moved, drive] : joints) {
      chain.joints.push_back({type, placement, axis, bounds, std::string(name), mimic, moved, drive});
    }
    return chain;
  }
};

template <typename Scalar>
struct Chain<Scalar, Eigen::Dynamic> {
  std::vector<Joint<Scalar>> joints;
  Transform<Scalar> tip = {};
};

/// Joint i of a chain.
template <typename Scalar, int Length>
[[nodiscard]] const auto& joint_of(const Chain<Scalar, Length>& chain, Eigen::Index i) noexcept {
  return chain.joints[static_cast<std::size_t>(i)];
}

namespace chain_check {

/// Name of joint i of a chain or a tree in messages.
template <typename Source>
validation::Argument name_of(const Source& source, Eigen::Index i) {
  const std::string_view name = joint_of(source, i).name;
  return name.empty() ? validation::element("joints", i) : validation::Argument("joint '") + name + "'";
}

/// Whether a matrix is a rotation, up to errors in the second half of the digits: an input with 9 decimals, or 4 for
/// float, is accepted.
template <typename Scalar>
[[nodiscard]] bool is_rotation(const Matrix<3, 3, Scalar>& R) noexcept {
  const auto tolerance = std::sqrt(std::numeric_limits<Scalar>::epsilon());
  const Three<Scalar> axes[3] = {three(R.data()), three(R.data() + 3), three(R.data() + 6)};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!(std::abs(dot(axes[i], axes[j]) - (i == j ? Scalar(1) : Scalar(0))) <= tolerance)) return false;
    }
  }
  return dot(cross(axes[0], axes[1]), axes[2]) >= Scalar(0);
}

template <typename Scalar>
void require_transform(const validation::Argument& name, const Transform<Scalar>& transform) {
  validation::require_finite(name + ".p", transform.p);
  for (int i = 0; i < 9; ++i) validation::require_finite(element(name + ".R", i), transform.R.data()[i]);
  if (!is_rotation(transform.R)) validation::reject(name + ".R", ": must be a rotation matrix");
}

template <typename Scalar>
void require_bounds(const validation::Argument& name, JointType type, const JointBounds<Scalar>& bounds) {
  const auto& [lower, upper, velocity, acceleration, jerk, velocity_offset, deceleration, effort] = bounds;
  if (!(lower < upper)) validation::fail(name + ".lower", lower, "below upper = ", upper);
  if (type == JointType::kContinuous && (std::isfinite(lower) || std::isfinite(upper))) {
    validation::reject(name, " is continuous: must have no lower and no upper bound");
  }
  const auto require_positive = [&](const char* part, Scalar value) {
    if (!(value > Scalar(0))) validation::fail(name + part, value, "positive");
  };
  require_positive(".velocity", velocity);
  require_positive(".acceleration", acceleration);
  require_positive(".jerk", jerk);
  require_positive(".deceleration", deceleration);
  require_positive(".effort", effort);
  validation::require_non_negative(name + ".velocity_offset", velocity_offset);
}

template <typename Scalar>
void require_inertia(const validation::Argument& name, const LinkInertia<Scalar>& inertia) {
  validation::require_non_negative(name + ".mass", inertia.mass);
  validation::require_finite(name + ".centre", inertia.centre);
  for (int i = 0; i < 9; ++i) validation::require_finite(element(name + ".inertia", i), inertia.inertia.data()[i]);
}

template <typename Scalar, typename Name>
void require_joint(const validation::Argument& name, const Joint<Scalar, Name>& joint) {
  require_transform(name + ".placement", joint.placement);
  validation::require_finite(name + ".axis", joint.axis);
  if (!(norm(joint.axis) > Scalar(0))) validation::reject(name + ".axis", " is zero: must be a nonzero vector");
  require_bounds(name, joint.type, joint.bounds);
  require_inertia(name + ".moved", joint.moved);
  validation::require_non_negative(name + ".drive.rotor_inertia", joint.drive.rotor_inertia);
  validation::require_non_negative(name + ".drive.viscous", joint.drive.viscous);
  validation::require_non_negative(name + ".drive.dry", joint.drive.dry);
}

}  // namespace chain_check

/// Checks a chain and returns its number of joints.
///
/// Throws std::invalid_argument if the number of joints is 0 or exceeds kMaxDof, an axis is zero, a number is not
/// finite, R of a placement or of the tip is not a rotation, a velocity, acceleration, jerk or deceleration is not
/// positive, or lower and upper leave no range for a joint. The message has the name of the joint, if any.
template <typename Scalar, int Length>
Eigen::Index require_joints(const Chain<Scalar, Length>& chain) {
  const auto dof = static_cast<Eigen::Index>(chain.joints.size());
  validation::require_dof("joints", dof, 1);
  for (Eigen::Index i = 0; i < dof; ++i) chain_check::require_joint(chain_check::name_of(chain, i), joint_of(chain, i));
  chain_check::require_transform("tip", chain.tip);
  return dof;
}

/// require_joints() for an arm of n joints (Eigen::Dynamic: any number) without joints that follow other joints.
template <typename Scalar, int Length>
Eigen::Index require_chain(const Chain<Scalar, Length>& chain, int n = Eigen::Dynamic) {
  if (n != Eigen::Dynamic) validation::require_size("joints", static_cast<Eigen::Index>(chain.joints.size()), n);
  const Eigen::Index dof = require_joints(chain);
  for (Eigen::Index i = 0; i < dof; ++i) {
    if (joint_of(chain, i).mimic.joint >= 0) {
      validation::reject(chain_check::name_of(chain, i), " is a mimic joint: must be in a CoupledArm");
    }
  }
  return dof;
}

}  // namespace fpbm
