#pragma once

#include <Eigen/Core>

#include "fpbm/core/mask.hpp"
#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Where the joints of a chain have their axes, and how these move: what J and Jd are made of.
///
/// Column i of J is [zᵢ × (p − pᵢ); zᵢ] for a joint that turns about zᵢ through pᵢ, the tip being at p, and column i of
/// Jd its rate.
template <int N, typename Scalar>
struct Screws {
  using Vector3 = Vector<3, Scalar>;
  /// One row a joint, so that several joints are done at once. Eigen wants a single row to be stored as one.
  using JointVectors3 =
      Eigen::Matrix<Scalar, N, 3, (N == 1 ? Eigen::RowMajor : Eigen::ColMajor) | Eigen::DontAlign, kCapacity<N>, 3>;

  JointVectors3 axes;
  JointVectors3 points;
  JointVectors3 axis_rates;
  JointVectors3 point_rates;

  explicit Screws(Eigen::Index dof) : axes(dof, 3), points(dof, 3), axis_rates(dof, 3), point_rates(dof, 3) {}

  /// Sees every joint from the tip at p, which moves by v: what columns() and column_rates() ask for first.
  template <bool kWithRate>
  void relative_to_tip(const Vector3& p, [[maybe_unused]] const Vector3& v) noexcept {
    for (int i = 0; i < 3; ++i) {
      points.col(i).array() = p(i) - points.col(i).array();
      if constexpr (kWithRate) point_rates.col(i).array() = v(i) - point_rates.col(i).array();
    }
  }

  /// The columns of J: its linear rows and, where there are six, its angular ones.
  template <int M>
  void columns(Matrix<M, N, Scalar>& J) const noexcept {
    fill(
        J, axes, [this](int i) { return cross_entry(axes, points, i); },
        [this](Eigen::Index j) { return cross_joint(axes, points, j); });
  }

  /// Their rates.
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
  /// Entry i of all joints' a × b.
  [[nodiscard]] static auto cross_entry(const JointVectors3& a, const JointVectors3& b, int i) noexcept {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    return a.col(j).cwiseProduct(b.col(k)) - a.col(k).cwiseProduct(b.col(j));
  }

  /// Joint j's a × b.
  [[nodiscard]] static Vector3 cross_joint(const JointVectors3& a, const JointVectors3& b, Eigen::Index j) noexcept {
    return cross<Scalar>(a.row(j), b.row(j));
  }

  /// Linear rows over angular ones. Entry by entry, all joints at once, where that makes vector code of it; joint by
  /// joint where each number is many already.
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
