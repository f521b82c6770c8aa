#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/model/detail/continuous_joints.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm {

/// Joints of a robot that have a drive, and joints that follow a drive (gears, belts, URDF's mimic): position of joint
/// i = ratio(i) · position of drive(i) + offset(i). There are N drives and any number of joints up to Joints.
template <int N, int Joints, typename Scalar>
class Drives {
 public:
  using JointVector = Vector<Joints, Scalar>;
  /// Whether a joint can follow another joint. Otherwise, all joints have a drive, and nothing is stored.
  static constexpr bool kMayFollow = Joints != N || N == Eigen::Dynamic;

  /// Throws std::invalid_argument if a mimic is out of range, the number of joints with a drive is not N, or a drive
  /// has no range in which its followers keep their bounds.
  template <typename Source>
  explicit Drives(const Source& source) : limits_(JointLimits<N, Scalar>::none(count_drives(source))) {
    const auto count = static_cast<Eigen::Index>(source.joints.size());
    if constexpr (kMayFollow) {
      ratio_ = filled<JointVector>(count, Scalar(1));
      offset_ = filled<JointVector>(count);
      drive_.fill(-1);
    }
    Eigen::Index drive = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto& joint = joint_of(source, i);
      if (joint.mimic.joint >= 0) continue;
      if constexpr (kMayFollow) drive_[index(i)] = static_cast<int>(drive);
      if (is_continuous(joint.type, joint.bounds)) limits_.continuous |= joint_bit(drive);
      limits_.set(drive++, joint.bounds);
    }
    follows_ = Joints != N || drive < count;
    for (Eigen::Index i = 0; i < count && follows_; ++i) {
      if (joint_of(source, i).mimic.joint >= 0) follow(source, i);
    }
  }

  [[nodiscard]] Eigen::Index count() const noexcept { return limits_.lower.size(); }
  /// Whether any joint follows another joint.
  [[nodiscard]] bool follows() const noexcept { return kMayFollow && follows_; }
  /// Bounds on the drives within which all joints, including followers, keep their bounds.
  [[nodiscard]] const JointLimits<N, Scalar>& limits() const noexcept { return limits_; }

  /// Positions of the joints from the positions of the drives.
  [[nodiscard]] JointVector positions(const Vector<N, Scalar>& q) const noexcept {
    return entrywise(ratio_, [&](Eigen::Index i) { return ratio_.coeff(i) * q.coeff(drive(i)) + offset_.coeff(i); });
  }
  /// Velocities of the joints from the velocities of the drives.
  [[nodiscard]] JointVector rates(const Vector<N, Scalar>& qd) const noexcept {
    if constexpr (kMayFollow) {
      return entrywise(ratio_, [&](Eigen::Index i) { return ratio_.coeff(i) * qd.coeff(drive(i)); });
    } else {
      return qd;
    }
  }
  /// Smallest velocities of the joints if the velocities of the drives are between low and high.
  [[nodiscard]] JointVector least(const Vector<N, Scalar>& low, const Vector<N, Scalar>& high) const noexcept {
    if constexpr (kMayFollow) {
      return entrywise(ratio_, [&](Eigen::Index i) {
        const Scalar ratio = ratio_.coeff(i);
        return ratio * (ratio > Scalar(0) ? low : high).coeff(drive(i));
      });
    } else {
      return low;
    }
  }
  /// Gradient with respect to the drives, from the gradient with respect to the joints.
  [[nodiscard]] Vector<N, Scalar> by_drive(const JointVector& gradient) const noexcept {
    if constexpr (kMayFollow) {
      Vector<N, Scalar> result = filled<Vector<N, Scalar>>(count());
      for (Eigen::Index i = 0; i < gradient.size(); ++i) {
        result.coeffRef(drive(i)) += ratio_.coeff(i) * gradient.coeff(i);
      }
      return result;
    } else {
      return gradient;
    }
  }
  /// Sets columns of the drives from columns of the joints.
  template <int M>
  void set_by_drive(const Matrix<M, Joints, Scalar>& columns, Matrix<M, N, Scalar>& to) const noexcept {
    if constexpr (kMayFollow) {
      to.resize(columns.rows(), count());
      for (Eigen::Index k = 0; k < to.size(); ++k) to.coeffRef(k) = Scalar(0);
      for (Eigen::Index i = 0; i < columns.cols(); ++i) {
        for (Eigen::Index row = 0; row < columns.rows(); ++row) {
          to.coeffRef(row, drive(i)) += ratio_.coeff(i) * columns.coeff(row, i);
        }
      }
    } else {
      to = columns;
    }
  }
  /// Calls f(i, columns, rates) with columns i and i + 1 of J and J̇ of the drives. The column of a drive is a sum over
  /// joints. of_joints(set) calls set(i, columns, rates) for the joints.
  template <typename Columns, typename OfJoints, typename F>
  void each_column(const OfJoints& of_joints, const F& f) const noexcept {
    Matrix<6, Joints, Scalar> J;
    Matrix<6, Joints, Scalar> Jd;
    J.resize(6, ratio_.size());
    Jd.resize(6, ratio_.size());
    of_joints([&](Eigen::Index i, const auto& columns, const auto& rates) noexcept {
      columns.store(J, i);
      rates.store(Jd, i);
    });
    Matrix<6, N, Scalar> of_drives;
    Matrix<6, N, Scalar> rates_of_drives;
    set_by_drive(J, of_drives);
    set_by_drive(Jd, rates_of_drives);
    for (Eigen::Index i = 0; i < count(); i += 2) f(i, Columns::load(of_drives, i), Columns::load(rates_of_drives, i));
  }

  /// Index of the drive of joint i.
  [[nodiscard]] Eigen::Index drive(Eigen::Index i) const noexcept { return drive_[index(i)]; }

 private:
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }

  template <typename Source>
  [[nodiscard]] static Eigen::Index count_drives(const Source& source) {
    const auto count = static_cast<Eigen::Index>(source.joints.size());
    Eigen::Index drives = 0;
    for (Eigen::Index i = 0; i < count; ++i) drives += joint_of(source, i).mimic.joint < 0 ? 1 : 0;
    validation::require_dof("list of joints with a drive", drives, 1);
    if constexpr (N != Eigen::Dynamic) validation::require_size("list of joints with a drive", drives, N);
    return drives;
  }

  template <typename Source>
  void follow(const Source& source, Eigen::Index i) {
    const auto& joint = joint_of(source, i);
    const validation::Argument name = chain_check::name_of(source, i);
    const auto count = static_cast<int>(source.joints.size());
    const auto& [leader, ratio, offset] = joint.mimic;
    if (leader >= count || joint_of(source, leader).mimic.joint >= 0) {
      validation::fail(name + ".mimic.joint", leader, "the index of a joint with its own drive");
    }
    validation::require_finite(name + ".mimic.ratio", ratio);
    validation::require_finite(name + ".mimic.offset", offset);
    if constexpr (kMayFollow) {
      drive_[index(i)] = drive_[index(leader)];
      ratio_(i) = ratio;
      offset_(i) = offset;
      narrow(joint, name, chain_check::name_of(source, leader), drive(i));
    }
  }

  /// Narrows the bounds of drive k so that a joint that follows the drive keeps its own bounds.
  template <typename Name>
  void narrow(const Joint<Scalar, Name>& joint, const validation::Argument& name, const validation::Argument& leader,
              Eigen::Index k) {
    const JointBounds<Scalar>& bounds = joint.bounds;
    const auto [_, ratio, offset] = joint.mimic;
    if (ratio == Scalar(0)) {
      if (!(bounds.lower <= offset && offset <= bounds.upper)) {
        validation::fail(name + ".mimic.offset", offset, "within the bounds, since the ratio is 0");
      }
      return;
    }
    // A turn of the drive leaves the posture unchanged only if it moves every follower by whole turns.
    if (joint.type == JointType::kPrismatic || ratio != std::round(ratio)) limits_.continuous &= ~joint_bit(k);
    Scalar& lower = limits_.lower(k);
    Scalar& upper = limits_.upper(k);
    const Scalar low = (bounds.lower - offset) / ratio;
    const Scalar high = (bounds.upper - offset) / ratio;
    lower = std::max(lower, std::min(low, high));
    upper = std::min(upper, std::max(low, high));
    limits_.velocity(k) = std::min(limits_.velocity(k), bounds.velocity / std::abs(ratio));
    limits_.acceleration(k) = std::min(limits_.acceleration(k), bounds.acceleration / std::abs(ratio));
    limits_.jerk(k) = std::min(limits_.jerk(k), bounds.jerk / std::abs(ratio));
    // The follower has at most the whole effort of the drive, divided by the ratio.
    limits_.effort(k) = std::min(limits_.effort(k), bounds.effort * std::abs(ratio));
    if (bounds.deceleration < JointBounds<Scalar>::kNone) {
      validation::fail(name + ".deceleration", bounds.deceleration, "infinite for a mimic joint");
    }
    if (std::isfinite(lower) || std::isfinite(upper)) limits_.continuous &= ~joint_bit(k);
    if (!(lower < upper)) {
      validation::fail(leader + ".lower", lower, "below upper = ", upper, " for its mimic joints to keep their bounds");
    }
  }

  static constexpr int kStored = kMayFollow ? Joints : 0;
  std::array<int, kMayFollow ? kCapacity<Joints> : 0> drive_;
  Vector<kStored, Scalar> ratio_;
  Vector<kStored, Scalar> offset_;
  bool follows_ = false;
  JointLimits<N, Scalar> limits_;
};

}  // namespace fpbm
