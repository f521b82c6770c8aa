#pragma once

#include <cmath>

#include "fpbm/core/level.hpp"
#include "fpbm/core/parts.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/linalg/sums.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Corrects a loop's reference before the scheme sees it: a target beyond options.error_bound is brought to that
/// distance (Buss 2004), its angle to that angle, and the integral of the error is added.
template <Level kLevel, typename Space, typename Scalar = double>
class Correction {
 public:
  using Twist = Vector<Space::kRows, Scalar>;

  /// Throws std::invalid_argument where an option is out of range.
  explicit Correction(const TrackerOptions<Scalar>& options)
      : dt_(options.dt),
        error_bound_(options.error_bound),
        gain_(options.integral_gain),
        bound_(options.integral_bound) {
    validation::require_positive("error_bound", error_bound_);
    validation::require_non_negative("integral_gain", gain_);
    validation::require_positive("integral_bound", bound_);
  }

  /// Call at the start of a tick, with its error and the arm's characteristic length.
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
      bool far = false;
      if constexpr (kLengths > 0) far = bring_near<kLengths>(from, error_bound_ * length, to);
      if constexpr (Part::kTurns > 0) {
        far = bring_near<Part::kTurns>(from + kLengths, error_bound_, to + kLengths) || far;
      }
      moved_ = moved_ || far;
      far_ = far_ || (first && far);
    });
  }

  /// Whether the target, of the first level, lies beyond error_bound.
  [[nodiscard]] bool far() const noexcept { return far_; }
  /// Whether it changes a reference.
  [[nodiscard]] bool active() const noexcept { return moved_ || gain_ != Scalar(0); }
  /// What begin() was told.
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

  /// Sets the integral of some rows to zero.
  void forget(int row, int rows) noexcept {
    for (int i = row; i < row + rows; ++i) integral_(i) = Scalar(0);
  }

  /// Call at the end of a tick that did the whole first level. Each task has its own integral and bound. The integral
  /// of a lower level waits while the level is slowed or has no finite reference.
  template <typename Result>
  void integrate(const Result& tick) noexcept {
    if (gain_ == Scalar(0) || far_) return;
    each_part<Space>([&](auto space, int row, bool first) noexcept {
      using Part = decltype(space);
      Vector<Part::kRows, Scalar> integral;
      for (int i = 0; i < Part::kRows; ++i) integral(i) = integral_(row + i) + dt_ * error_(row + i);
      const Scalar size = gain_ * norm(in_lengths<Part>(integral, length_));
      if (!std::isfinite(size) || (!first && lower_scale(tick, row) < Scalar(1))) return;
      const Scalar share = size > bound_ ? bound_ / size : Scalar(1);
      for (int i = 0; i < Part::kRows; ++i) integral_(row + i) = share * integral(i);
    });
  }

 private:
  /// The part of an error of some rows beyond a bound; whether there is one, or the error is not a number.
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
  bool moved_ = false;         ///< Some target is brought nearer.
  Scalar length_ = Scalar(1);  ///< Of the arm [m].
  Twist error_ = filled<Twist>(Space::kRows);
  Twist excess_ = filled<Twist>(Space::kRows);
  Twist integral_ = filled<Twist>(Space::kRows);
};

}  // namespace fpbm
