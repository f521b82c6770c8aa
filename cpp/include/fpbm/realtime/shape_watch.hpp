#pragma once

#include <cmath>

namespace fpbm {

/// Detects whether shapes near an arm have moved since the arm stopped.
template <typename Scalar>
class ShapeWatch {
 public:
  /// Call once per tick. Returns whether the shapes have moved. room: a measure of their distances [m]. least: smallest
  /// change of room that counts [m].
  [[nodiscard]] bool moved(bool at_rest, Scalar room, Scalar least) noexcept {
    if (rests_ && std::abs(room - room_) > least) return true;
    if (at_rest && !rests_) room_ = room;
    rests_ = rests_ || at_rest;
    return false;
  }

  void reset() noexcept { rests_ = false; }

 private:
  bool rests_ = false;       ///< Whether the arm has stopped.
  Scalar room_ = Scalar(0);  ///< `room` when the arm stopped [m].
};

}  // namespace fpbm
