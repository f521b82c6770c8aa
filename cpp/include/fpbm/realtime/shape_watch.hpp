#pragma once

#include <cmath>

namespace fpbm {

/// Whether shapes near an arm have moved since the arm came to rest.
template <typename Scalar>
class ShapeWatch {
 public:
  /// One more tick. room: a measure of the shapes' distances [m]. least: the least change of it that counts [m].
  [[nodiscard]] bool moved(bool at_rest, Scalar room, Scalar least) noexcept {
    if (rests_ && std::abs(room - room_) > least) return true;
    if (at_rest && !rests_) room_ = room;
    rests_ = rests_ || at_rest;
    return false;
  }

  void reset() noexcept { rests_ = false; }

 private:
  bool rests_ = false;       ///< The arm has come to rest.
  Scalar room_ = Scalar(0);  ///< When it did.
};

}  // namespace fpbm
