#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

enum class JointType : unsigned char { kRevolute, kPrismatic };

/// One joint of a chain.
template <typename Scalar = double>
struct Joint {
  JointType type = JointType::kRevolute;
  Transform<Scalar> placement = {};  ///< The joint's frame, seen from the joint before, both at zero.
  Vector<3, Scalar> axis = Vector<3, Scalar>::UnitZ();  ///< In the joint's frame; its length does not matter.
};

/// Any chain of N revolute and prismatic joints, in space. Immutable.
///
/// Joint positions in radians or metres, the base frame is that of the first placement. N = Eigen::Dynamic takes the
/// number of joints from the chain, up to kMaxDof.
template <int N, typename Scalar_ = double>
class SerialArm {
 public:
  using Scalar = Scalar_;
  static constexpr int kDof = N;

  /// The chain from base to tip; tip is the tip's frame seen from the last joint.
  /// Throws std::invalid_argument where their number is not N or beyond kMaxDof, an axis is zero, a number is not
  /// finite, or a placement's R is no rotation.
  explicit SerialArm(const std::vector<Joint<Scalar>>& joints, const Transform<Scalar>& tip = {})
      : dof_(static_cast<Eigen::Index>(joints.size())) {
    validation::require_dof("joints", dof_, 1);
    if constexpr (N != Eigen::Dynamic) validation::require_size("joints", dof_, N);
    // Each joint's frame is turned so that its axis is z: then all joints move alike.
    Matrix<3, 3, Scalar> turned_back = Matrix<3, 3, Scalar>::Identity();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const std::string name = validation::element("joints", static_cast<Eigen::Index>(i));
      require_transform(name + ".placement", joints[i].placement);
      const Matrix<3, 3, Scalar> to_axis = z_to(name + ".axis", joints[i].axis);
      links_[i].p = turned_back * joints[i].placement.p;
      links_[i].R = turned_back * joints[i].placement.R * to_axis;
      turned_back = to_axis.transpose();
      types_[i] = joints[i].type;
    }
    require_transform("tip", tip);
    tip_.p = turned_back * tip.p;
    tip_.R = turned_back * tip.R;
  }

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(dof_); }

  /// Tip, J and Jd at (q, qd), for the task spaces Position<3> and Pose.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, const Vector<N, Scalar>& qd,
                  Kinematics<Space, N, Scalar>& out) const noexcept {
    sweep<true>(q, qd, out);
  }

  /// Tip and J at q; leaves Jd alone.
  template <typename Space>
  void kinematics(const Vector<N, Scalar>& q, Kinematics<Space, N, Scalar>& out) const noexcept {
    sweep<false>(q, q, out);
  }

 private:
  using Row3 = Vector<3, Scalar>;

  /// Out along the chain for axes zᵢ, origins pᵢ and their rates; then column i of J is [zᵢ × (p − pᵢ); zᵢ] for a
  /// revolute joint, [zᵢ; 0] for a prismatic one, and column i of Jd its rate.
  template <bool kWithRate, typename Space>
  void sweep(const Vector<N, Scalar>& q, [[maybe_unused]] const Vector<N, Scalar>& qd,
             Kinematics<Space, N, Scalar>& out) const noexcept {
    constexpr bool kWithTurn = std::is_same_v<Space, Pose>;
    static_assert(kWithTurn || std::is_same_v<Space, Position<3>>, "a serial arm has tasks Position<3> and Pose");
    out.J.resize(Space::kRows, dof_);
    if constexpr (kWithRate) out.Jd.resize(Space::kRows, dof_);
    Vector<N, Scalar> sines;
    Vector<N, Scalar> cosines;
    sincos(q, sines, cosines);

    std::array<Row3, kCapacity<N>> origins;
    std::array<Row3, kCapacity<N>> velocities;
    std::array<Row3, kCapacity<N>> axes;
    std::array<Row3, kCapacity<N>> axis_rates;
    Transform<Scalar> frame;
    Row3 v = Row3::Zero();  // Of the frame's origin,
    Row3 w = Row3::Zero();  // and the frame's angular velocity.
    const auto advance = [&](const Row3& step) {
      frame.p += step;
      if constexpr (kWithRate) v += cross(w, step);
    };
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      advance(frame.R.lazyProduct(links_[k].p));
      frame.R = frame.R.lazyProduct(links_[k].R).eval();
      const Row3 z = frame.R.col(2);
      axes[k] = z;
      if constexpr (kWithRate) axis_rates[k] = cross(w, z);
      if (types_[k] == JointType::kRevolute) {
        const Row3 x = frame.R.col(0);
        frame.R.col(0) = cosines(i) * x + sines(i) * frame.R.col(1);
        frame.R.col(1) = cosines(i) * frame.R.col(1) - sines(i) * x;
        if constexpr (kWithRate) w += qd(i) * z;
      } else {
        advance(q(i) * z);
        if constexpr (kWithRate) v += qd(i) * z;
      }
      origins[k] = frame.p;
      if constexpr (kWithRate) velocities[k] = v;
    }
    advance(frame.R.lazyProduct(tip_.p));

    for (Eigen::Index i = 0; i < dof_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const bool turns = types_[k] == JointType::kRevolute;
      const Row3 arm = frame.p - origins[k];
      out.J.col(i).template head<3>() = turns ? cross(axes[k], arm) : axes[k];
      if constexpr (kWithTurn) out.J.col(i).template tail<3>() = turns ? axes[k] : Row3::Zero();
      if constexpr (kWithRate) {
        const Row3 rate = v - velocities[k];
        out.Jd.col(i).template head<3>() =
            turns ? Row3(cross(axis_rates[k], arm) + cross(axes[k], rate)) : axis_rates[k];
        if constexpr (kWithTurn) out.Jd.col(i).template tail<3>() = turns ? axis_rates[k] : Row3::Zero();
      }
    }
    if constexpr (kWithTurn) {
      out.tip = {frame.p, frame.R.lazyProduct(tip_.R)};
    } else {
      out.tip = frame.p;
    }
  }

  static void require_transform(const std::string& name, const Transform<Scalar>& transform) {
    validation::require_finite((name + ".p").c_str(), transform.p);
    validation::require_finite((name + ".R").c_str(), transform.R.reshaped());
    const Matrix<3, 3, Scalar> gram = transform.R.transpose() * transform.R;
    const auto tolerance = std::sqrt(std::numeric_limits<Scalar>::epsilon());
    const Scalar off = (gram - Matrix<3, 3, Scalar>::Identity()).cwiseAbs().maxCoeff();
    const Row3 x = transform.R.col(0);
    const Row3 y = transform.R.col(1);
    if (off > tolerance || cross(x, y).dot(transform.R.col(2)) < Scalar(0)) {
      throw std::invalid_argument(name + ".R: must be a rotation matrix");
    }
  }

  /// A rotation that takes z to the axis.
  static Matrix<3, 3, Scalar> z_to(const std::string& name, const Row3& axis) {
    validation::require_finite(name.c_str(), axis);
    if (!(axis.norm() > Scalar(0))) throw std::invalid_argument(name + " is zero: must point somewhere");
    Matrix<3, 3, Scalar> R;
    const Row3 z = axis.normalized();
    Eigen::Index least = 0;
    z.cwiseAbs().minCoeff(&least);
    if (z == Row3::UnitZ()) return Matrix<3, 3, Scalar>::Identity();
    const Row3 across = Row3::Unit(least);
    const Row3 x = cross(across, z).normalized();
    R.col(0) = x;
    R.col(1) = cross(z, x);
    R.col(2) = z;
    return R;
  }

  Eigen::Index dof_;
  std::array<Transform<Scalar>, kCapacity<N>> links_;
  std::array<JointType, kCapacity<N>> types_{};
  Transform<Scalar> tip_;
};

}  // namespace fpbm
