#pragma once

#include <cmath>

namespace fpbm {

/// Detects whether shapes near an arm have moved since the arm stopped.
template <typename Scalar>
class ShapeWatch {
 public:
  /// Call once per tick. Returns whether the shapes have moved. distance_sum: Bounds::near_distance_sum() [m]. least:
  /// smallest change of distance_sum that counts [m].
  [[nodiscard]] bool moved(bool at_rest, Scalar distance_sum, Scalar least) noexcept {
    if (at_rest_ && std::abs(distance_sum - distance_sum_) > least) return true;
    if (at_rest && !at_rest_) distance_sum_ = distance_sum;
    at_rest_ = at_rest_ || at_rest;
    return false;
  }

  void reset() noexcept { at_rest_ = false; }

 private:
  bool at_rest_ = false;             ///< Whether the arm has stopped.
  Scalar distance_sum_ = Scalar(0);  ///< `distance_sum` when the arm stopped [m].
};

}  // namespace fpbm
