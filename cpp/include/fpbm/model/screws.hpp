#pragma once

#include <Eigen/Core>

#include "fpbm/core/mask.hpp"
#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// The axes of a chain's joints and their rates, from which J and Jd follow.
///
/// Column i of J is [zᵢ × (p − pᵢ); zᵢ] for a joint that turns about the axis zᵢ through pᵢ, with the tip at p. Column
/// i of Jd is its time derivative.
template <int N, typename Scalar>
struct Screws {
  using Vector3 = Vector<3, Scalar>;
  /// One row per joint, so that vector code computes several joints at once. Eigen demands row-major for a single row.
  using JointVectors3 =
      Eigen::Matrix<Scalar, N, 3, (N == 1 ? Eigen::RowMajor : Eigen::ColMajor) | Eigen::DontAlign, kCapacity<N>, 3>;

  JointVectors3 axes;
  JointVectors3 points;
  JointVectors3 axis_rates;
  JointVectors3 point_rates;

  explicit Screws(Eigen::Index dof) : axes(dof, 3), points(dof, 3), axis_rates(dof, 3), point_rates(dof, 3) {}

  /// Makes points and their rates relative to the tip at p with velocity v. Call it before columns() and
  /// column_rates().
  template <bool kWithRate>
  void relative_to_tip(const Vector3& p, [[maybe_unused]] const Vector3& v) noexcept {
    for (int i = 0; i < 3; ++i) {
      points.col(i).array() = p(i) - points.col(i).array();
      if constexpr (kWithRate) point_rates.col(i).array() = v(i) - point_rates.col(i).array();
    }
  }

  /// The columns of J: linear rows and, where there are six rows, angular ones.
  template <int M>
  void columns(Matrix<M, N, Scalar>& J) const noexcept {
    fill(
        J, axes, [this](int i) { return cross_entry(axes, points, i); },
        [this](Eigen::Index j) { return cross_joint(axes, points, j); });
  }

  /// The columns of Jd.
  template <int M>
  void column_rates(Matrix<M, N, Scalar>& Jd) const noexcept {
    fill(
        Jd, axis_rates,
        [this](int i) { return cross_entry(axis_rates, points, i) + cross_entry(axes, point_rates, i); },
        [this](Eigen::Index j) {
          return Vector3(cross_joint(axis_rates, points, j) + cross_joint(axes, point_rates, j));
        });
  }

 private:
  /// Entry i of a × b of all joints.
  [[nodiscard]] static auto cross_entry(const JointVectors3& a, const JointVectors3& b, int i) noexcept {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    return a.col(j).cwiseProduct(b.col(k)) - a.col(k).cwiseProduct(b.col(j));
  }

  /// a × b of joint j.
  [[nodiscard]] static Vector3 cross_joint(const JointVectors3& a, const JointVectors3& b, Eigen::Index j) noexcept {
    return cross<Scalar>(a.row(j), b.row(j));
  }

  /// Linear rows above angular ones. Entry by entry for all joints at once, which vectorises; joint by joint in lanes.
  template <int M, typename Entry, typename Joint>
  static void fill(Matrix<M, N, Scalar>& result, const JointVectors3& angular, [[maybe_unused]] const Entry& entry,
                   [[maybe_unused]] const Joint& joint) noexcept {
    if constexpr (kInLanes<Scalar>) {
      for (Eigen::Index j = 0; j < angular.rows(); ++j) result.col(j).template head<3>() = joint(j);
    } else {
      JointVectors3 linear(angular.rows(), 3);
      for (int i = 0; i < 3; ++i) linear.col(i) = entry(i);
      result.template topRows<3>() = linear.transpose();
    }
    if constexpr (M == 6) result.template bottomRows<3>() = angular.transpose();
  }
};

}  // namespace fpbm
