#pragma once

#include <cmath>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/detail/joint_space.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/realtime/tick.hpp"

namespace fpbm {

/// Corrects the reference of a loop before the scheme uses it. If the error exceeds options.error_bound, the target is
/// moved toward the tip until the error equals error_bound, separately for the position and the orientation (Buss
/// 2004). For the joints of a posture task, see reduce() and JointApproach. The integral of the error, times
/// integral_gain, is added to the acceleration of the reference, or to the velocity at velocity level
/// (docs/measured.md, Integral of the error).
template <Level kLevel, typename Space, typename Scalar = double>
class Correction {
 public:
  using Twist = Vector<Space::kRows, Scalar>;

  /// Throws std::invalid_argument if an option is out of range.
  explicit Correction(const TrackerOptions<Scalar>& options)
      : dt_(options.dt),
        error_bound_(options.error_bound),
        gain_(options.integral_gain),
        bound_(options.integral_bound) {
    validation::require_positive("error_bound", error_bound_);
    validation::require_non_negative("integral_gain", gain_);
    validation::require_positive("integral_bound", bound_);
  }

  /// Call at the start of a tick. error: x ⊖ f(q) at the start [m, rad]. length: the arm's characteristic length [m].
  void begin(const Twist& error, Scalar length) noexcept {
    error_ = error;
    excess_ = filled<Twist>(Space::kRows);
    length_ = length;
    far_ = false;
    moved_ = false;
    each_part<Space>([&](auto space, int row, bool first) noexcept {
      using Part = decltype(space);
      constexpr int kLengths = Part::kRows - Part::kTurns;
      const Scalar* const from = error.data() + row;
      Scalar* const to = excess_.data() + row;
      if constexpr (kIsJointSpace<Part>) return;  // Joint by joint: reduce().
      bool far = false;
      if constexpr (kLengths > 0) far = bring_near<kLengths>(from, error_bound_ * length, to);
      if constexpr (Part::kTurns > 0) {
        far = bring_near<Part::kTurns>(from + kLengths, error_bound_, to + kLengths) || far;
      }
      moved_ = moved_ || far;
      far_ = far_ || (first && far);
    });
  }

  /// Sets the part of a row of a posture task's error that the feedback does not use. first: whether the task belongs
  /// to the first level.
  void reduce(int row, Scalar excess, bool first) noexcept {
    excess_(row) = excess;
    moved_ = true;
    far_ = far_ || first;
  }

  [[nodiscard]] Scalar error_bound() const noexcept { return error_bound_; }
  /// Whether the feedback uses only a part of an error of the first level.
  [[nodiscard]] bool far() const noexcept { return far_; }
  /// Whether the correction changes a reference.
  [[nodiscard]] bool active() const noexcept { return moved_ || gain_ != Scalar(0); }
  /// Arguments of the last begin().
  [[nodiscard]] const Twist& error() const noexcept { return error_; }
  [[nodiscard]] Scalar length() const noexcept { return length_; }

  [[nodiscard]] Reference<Space, Scalar> operator()(Reference<Space, Scalar> reference) const noexcept {
    if (moved_) {
      const Twist back = entrywise(excess_, [&](Eigen::Index i) { return -excess_.coeff(i); });
      reference.x = Space::template displace<Scalar>(reference.x, back);
    }
    if (gain_ != Scalar(0)) {
      Twist& corrected = kLevel == Level::kAcceleration ? reference.xdd : reference.xd;
      for (int i = 0; i < Space::kRows; ++i) corrected(i) += gain_ * integral_(i);
    }
    return reference;
  }

  /// Sets the integrals of some rows to zero. row: first row. rows: number of rows.
  void reset_integrals(int row, int rows) noexcept {
    for (int i = row; i < row + rows; ++i) integral_(i) = Scalar(0);
  }

  /// Call at the end of a tick that executed the whole first level. Each task has its own integral and bound. The
  /// integral of a lower level is constant while the level is slowed or has no finite reference.
  template <typename Result>
  void integrate(const Result& tick) noexcept {
    if (gain_ == Scalar(0) || far_) return;
    each_part<Space>([&](auto space, int row, bool first) noexcept {
      using Part = decltype(space);
      Vector<Part::kRows, Scalar> integral;
      for (int i = 0; i < Part::kRows; ++i) integral(i) = integral_(row + i) + dt_ * error_(row + i);
      const Scalar size = gain_ * norm(in_lengths<Part>(integral, length_));
      if (!std::isfinite(size) || (!first && lower_scale(tick, row) < Scalar(1))) return;
      const Scalar fraction = size > bound_ ? bound_ / size : Scalar(1);
      for (int i = 0; i < Part::kRows; ++i) integral_(row + i) = fraction * integral(i);
    });
  }

 private:
  /// Sets `excess` to the part of an error beyond a bound. Returns false, without setting `excess`, if the error is
  /// within the bound. A NaN counts as beyond the bound.
  template <int kRows>
  [[nodiscard]] static bool bring_near(const Scalar* error, Scalar bound, Scalar* excess) noexcept {
    Vector<kRows, Scalar> part;
    for (int i = 0; i < kRows; ++i) part(i) = error[i];
    const Scalar length = norm(part);
    if (length <= bound) return false;
    for (int i = 0; i < kRows; ++i) excess[i] = (Scalar(1) - bound / length) * error[i];
    return true;
  }

  Scalar dt_;
  Scalar error_bound_;
  Scalar gain_;
  Scalar bound_;
  bool far_ = false;
  bool moved_ = false;         ///< Whether a target is moved toward the tip.
  Scalar length_ = Scalar(1);  ///< Characteristic length of the arm [m].
  Twist error_ = filled<Twist>(Space::kRows);
  Twist excess_ = filled<Twist>(Space::kRows);
  Twist integral_ = filled<Twist>(Space::kRows);
};

}  // namespace fpbm
