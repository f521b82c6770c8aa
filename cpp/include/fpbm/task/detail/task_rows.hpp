#pragma once

#include <array>
#include <cstddef>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"
#include "fpbm/linalg/detail/diagonal_level.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/task/detail/tick_feedback.hpp"

namespace fpbm {

/// Joint velocities in the middle of a tick that continues the acceleration of the previous tick, and the accelerations
/// before this tick (docs/tick.md, A tick).
template <int N, typename Scalar>
struct TickBefore {
  Vector<N, Scalar> qd;             ///< q̇ in the middle of the tick [rad/s].
  const Vector<N, Scalar>& qdd;     ///< a', acceleration of the previous tick [rad/s²].
  const Vector<N, Scalar>& change;  ///< δ' = a' − a'', change of acceleration from the tick before [rad/s²].
};

/// Rows J and J̇ of a level, in metres.
template <int M, int N, typename Scalar>
struct LevelRows {
  Matrix<M, N, Scalar> J;
  Matrix<M, N, Scalar> Jd;
  Vector<M, Scalar> drift;  ///< Set by continue_tick() only [m/s²].

  // Not "= default": braces and std::tuple() would set all bytes to 0, which are 16 kB if the sizes are known at run
  // time.
  LevelRows() noexcept {}  // NOLINT(modernize-use-equals-default)

  void resize(Eigen::Index rows, Eigen::Index dof) noexcept {
    J.resize(rows, dof);
    Jd.resize(rows, dof);
    drift.resize(rows);
  }
  [[nodiscard]] Eigen::Index rows() const noexcept { return J.rows(); }
  [[nodiscard]] const Matrix<M, N, Scalar>& matrix() const noexcept { return J; }

  /// Linearises rows first … first + rows − 1 about a tick that continues the previous tick (docs/tick.md, A
  /// tick): J ← J + h'J̇, drift ← J̇ (qd − h'a' + correction (a' − a'')) − s ẍ', ẍ' = J a' + J̇ qd.
  void continue_tick(const TickFeedback<Scalar>& feedback, int first, Eigen::Index rows,
                     const TickBefore<N, Scalar>& before) noexcept {
    for (Eigen::Index i = first; i < first + rows; ++i) drift.coeffRef(i) = Scalar(0);
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      Scalar* const columns = &J.coeffRef(first, j);
      const Scalar* const rates = &Jd.coeffRef(first, j);
      const Scalar qd = (Scalar(1) - feedback.previous_weight) * before.qd.coeff(j) -
                        feedback.lead * before.qdd.coeff(j) + feedback.correction * before.change.coeff(j);
      subtract_multiple(drift.data() + first, feedback.previous_weight * before.qdd.coeff(j), columns, rows);
      subtract_multiple(drift.data() + first, -qd, rates, rows);
      subtract_multiple(columns, -feedback.lead, rates, rows);
    }
  }

  /// Linearises all rows about a tick at velocity level that continues the velocity u of the previous tick
  /// (continue_tick_of_velocity()): J ← J + hJ̇/2, drift ← −(J u + hJ̇u/4), or −hJ̇u/2 in float.
  void continue_velocity(Scalar h, const Vector<N, Scalar>& u) noexcept {
    const Scalar of_rates = h / (TickFeedback<Scalar>::kByPositions ? Scalar(4) : Scalar(2));
    for (Eigen::Index i = 0; i < J.rows(); ++i) drift.coeffRef(i) = Scalar(0);
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      Scalar* const columns = J.data() + j * J.rows();
      const Scalar* const rates = Jd.data() + j * J.rows();
      if (TickFeedback<Scalar>::kByPositions) subtract_multiple(drift.data(), u.coeff(j), columns, J.rows());
      subtract_multiple(drift.data(), of_rates * u.coeff(j), rates, J.rows());
      subtract_multiple(columns, -h / Scalar(2), rates, J.rows());
    }
  }
};

/// Rows of a level that is a posture of all N joints: row i of J is 1 for joints[i] and 0 for the other joints, and J̇
/// is 0.
template <int N, typename Scalar>
struct PostureRows {
  std::array<int, static_cast<std::size_t>(kCapacity<N>)> joints;
  Vector<N, Scalar> drift;  ///< −s a' of each row [rad/s²].

  PostureRows() noexcept {}  // NOLINT(modernize-use-equals-default): as LevelRows.

  void resize(Eigen::Index rows, Eigen::Index) noexcept { drift.resize(rows); }
  [[nodiscard]] static constexpr Eigen::Index rows() noexcept { return N; }
  /// The identity: the limits do not depend on the order of the rows.
  [[nodiscard]] static DiagonalLevel<N, Scalar> matrix() noexcept { return {filled<Vector<N, Scalar>>(N, Scalar(1))}; }

  /// See LevelRows::continue_tick().
  void continue_tick(const TickFeedback<Scalar>& feedback, int, Eigen::Index,
                     const TickBefore<N, Scalar>& before) noexcept {
    for (int i = 0; i < N; ++i) {
      drift.coeffRef(i) = -feedback.previous_weight * before.qdd.coeff(joints[static_cast<std::size_t>(i)]);
    }
  }

  /// See LevelRows::continue_velocity().
  void continue_velocity(Scalar, const Vector<N, Scalar>& u) noexcept {
    const bool by_positions = TickFeedback<Scalar>::kByPositions;
    for (int i = 0; i < N; ++i) {
      drift.coeffRef(i) = by_positions ? -u.coeff(joints[static_cast<std::size_t>(i)]) : Scalar(0);
    }
  }
};

/// Rows S J and S J̇ of one task, which Task::evaluate() sets, from row `first` of the level on.
template <int M, int N, typename Scalar>
class TaskRows {
 public:
  TaskRows(LevelRows<M, N, Scalar>& level, int first) noexcept : level_(level), first_(first) {}

  /// Sets column j, and column j + 1 if it exists, of row i.
  void set(Eigen::Index i, Eigen::Index j, const Pair<Scalar>& J, const Pair<Scalar>& Jd) noexcept {
    set_two(level_.J, first_ + i, j, J);
    set_two(level_.Jd, first_ + i, j, Jd);
  }

  /// Sets row i to 1 for a joint and 0 for the other joints, with J̇ = 0.
  void set_unit(Eigen::Index i, Eigen::Index joint) noexcept {
    for (Eigen::Index j = 0; j < level_.J.cols(); ++j) {
      level_.J.coeffRef(first_ + i, j) = j == joint ? Scalar(1) : Scalar(0);
      level_.Jd.coeffRef(first_ + i, j) = Scalar(0);
    }
  }

  /// Sets all rows of a task from matrices.
  template <int Rows>
  void set(const Matrix<Rows, N, Scalar>& J, const Matrix<Rows, N, Scalar>& Jd) noexcept {
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      for (Eigen::Index i = 0; i < J.rows(); ++i) {
        level_.J.coeffRef(first_ + i, j) = J.coeff(i, j);
        level_.Jd.coeffRef(first_ + i, j) = Jd.coeff(i, j);
      }
    }
  }

 private:
  static void set_two(Matrix<M, N, Scalar>& to, Eigen::Index i, Eigen::Index j, const Pair<Scalar>& two) noexcept {
    to.coeffRef(i, j) = two.first();
    if (j + 1 < to.cols()) to.coeffRef(i, j + 1) = two.second();
  }

  LevelRows<M, N, Scalar>& level_;
  int first_;
};

/// TaskRows for a posture of all joints.
template <int N, typename Scalar>
class TaskRowsOfPosture {
 public:
  explicit TaskRowsOfPosture(PostureRows<N, Scalar>& level) noexcept : level_(level) {}
  void set_unit(Eigen::Index i, int joint) noexcept { level_.joints[static_cast<std::size_t>(i)] = joint; }

 private:
  PostureRows<N, Scalar>& level_;
};

/// TaskRows without rows, if only the points of the tasks are evaluated.
struct NoRows {
  template <typename... Arguments>
  void set(const Arguments&...) const noexcept {}
  template <typename... Arguments>
  void set_unit(const Arguments&...) const noexcept {}
};

/// Rows of a task from row `first` of its level on.
template <int M, int N, typename Scalar>
[[nodiscard]] TaskRows<M, N, Scalar> rows_from(LevelRows<M, N, Scalar>& level, int first) noexcept {
  return {level, first};
}
template <int N, typename Scalar>
[[nodiscard]] TaskRowsOfPosture<N, Scalar> rows_from(PostureRows<N, Scalar>& level, int) noexcept {
  return TaskRowsOfPosture<N, Scalar>(level);
}

/// Entry j, and entry j + 1 if it exists, of a row of a matrix. Otherwise, the second entry of the pair is zero.
template <typename Whole, typename Scalar = typename Whole::Scalar>
[[nodiscard]] Pair<Scalar> two_of_row(const Whole& matrix, Eigen::Index row, Eigen::Index j) noexcept {
  return {matrix.coeff(row, j), j + 1 < matrix.cols() ? matrix.coeff(row, j + 1) : Scalar(0)};
}

/// aᵀv for a pair of vectors v.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline Pair<Scalar> along(const Vector<3, Scalar>& a,
                                                            const Vector<3, Pair<Scalar>>& v) noexcept {
  using Two = Pair<Scalar>;
  return Two(a.coeff(0)) * v.coeff(0) + Two(a.coeff(1)) * v.coeff(1) + Two(a.coeff(2)) * v.coeff(2);
}

}  // namespace fpbm
