#pragma once

#include <cstddef>
#include <tuple>

#include "fpbm/core/product_space.hpp"
#include "fpbm/realtime/tick_references.hpp"

namespace fpbm {

/// Holds the references of the first level while a stop keeps that level (TrackerOptions::keep_first_level).
template <typename Space, typename Scalar = double>
class HeldLevel {
 public:
  /// In all ticks after the first, the first level's targets are those of the first. They are at rest in all ticks.
  void hold(TickReferences<Space, Scalar>& references) noexcept {
    if (!holds_) target_ = references.stages[0].x;
    holds_ = true;
    for (Reference<Space, Scalar>& stage : references.stages) {
      if constexpr (kIsProduct<Space>) {
        Space::each([&](auto space, auto i, int row) noexcept {
          constexpr std::size_t kIndex = decltype(i)::value;
          if constexpr (kIndex < Space::kFirst) {
            std::get<kIndex>(stage.x) = std::get<kIndex>(target_);
            rest(stage, row, decltype(space)::kRows);
          }
        });
      } else {
        stage.x = target_;
        rest(stage, 0, Space::kRows);
      }
    }
  }
  void release() noexcept { holds_ = false; }

 private:
  static void rest(Reference<Space, Scalar>& stage, int row, int rows) noexcept {
    for (int j = row; j < row + rows; ++j) stage.xd(j) = stage.xdd(j) = Scalar(0);
  }

  bool holds_ = false;
  typename Space::template Point<Scalar> target_ = Space::template origin<Scalar>();
};

}  // namespace fpbm
