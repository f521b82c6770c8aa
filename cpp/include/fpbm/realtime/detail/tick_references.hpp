#pragma once

#include <array>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// References of a tick: at the start, in the middle and at the end of a tick.
template <typename Space, typename Scalar = double>
struct TickReferences {
  std::array<Reference<Space, Scalar>, 3> stages;
  Number<Scalar> dt;  ///< Length of the tick [s].

  /// ahead(seconds): reference after `seconds` [s] of the tick; noexcept.
  template <typename Ahead>
  [[nodiscard]] static TickReferences of(Ahead&& ahead, Number<Scalar> dt) noexcept {
    return {{ahead(Number<Scalar>(0)), ahead(dt / Number<Scalar>(2)), ahead(dt)}, dt};
  }

  [[nodiscard]] const Reference<Space, Scalar>& operator()(Number<Scalar> seconds) const noexcept {
    return stages[seconds < dt ? (seconds > Number<Scalar>(0) ? 1 : 0) : 2];
  }

  /// Reference of a tick (docs/tick.md, A tick): the reference in the middle. At velocity level, with the mean
  /// velocity of the tick, (xd₀ + 4xd + xd₁)/6. At acceleration level, with the mean acceleration of the tick, minus
  /// h/12 of the change of the jerk since the last tick: (xdd₀ + 4xdd + xdd₁)/6 − (change() − before)/12. With these,
  /// positions follow x at the ends of ticks. before: change() of the last tick.
  template <Level kLevel>
  [[nodiscard]] Reference<Space, Scalar> middle(const Vector<Space::kRows, Scalar>& before) const noexcept {
    Reference<Space, Scalar> reference = stages[1];
    if constexpr (kLevel == Level::kVelocity) {
      for (Eigen::Index i = 0; i < reference.xd.size(); ++i) {
        const Scalar xd = stages[1].xd.coeff(i);
        reference.xd.coeffRef(i) += (stages[0].xd.coeff(i) - xd - xd + stages[2].xd.coeff(i)) / Scalar(6);
      }
      return reference;
    }
    for (Eigen::Index i = 0; i < reference.xdd.size(); ++i) {
      const Scalar xdd = stages[1].xdd.coeff(i);
      const Scalar second_difference = stages[0].xdd.coeff(i) - xdd - xdd + stages[2].xdd.coeff(i);
      const Scalar change = stages[2].xdd.coeff(i) - stages[0].xdd.coeff(i);
      reference.xdd.coeffRef(i) += second_difference / Scalar(6) - (change - before.coeff(i)) / Scalar(12);
    }
    return reference;
  }

  /// Change of the acceleration during the tick.
  [[nodiscard]] Vector<Space::kRows, Scalar> change() const noexcept {
    return entrywise(stages[0].xdd, [&](Eigen::Index i) { return stages[2].xdd.coeff(i) - stages[0].xdd.coeff(i); });
  }

  /// Converts displacements from the point `start` to references in the base frame. Other: scalar type of the result,
  /// for example with lanes.
  template <typename Other>
  [[nodiscard]] TickReferences<Space, Other> from(const typename Space::template Point<Other>& start) const noexcept {
    TickReferences<Space, Other> placed{{}, dt};
    for (std::size_t i = 0; i < stages.size(); ++i) {
      placed.stages[i] = stages[i].template cast<Other>();
      placed.stages[i].x = Space::template compose<Other>(start, placed.stages[i].x);
    }
    return placed;
  }
};

/// TickReferences of a path that may be kept.
template <typename Space, typename Scalar = double>
struct PathReferences : TickReferences<Space, Scalar> {
  Number<Scalar> most_path_fraction;  ///< Largest Tick::path_fraction; 0: the path is not kept.
};
template <typename References>
inline constexpr bool kOfPath = false;
template <typename Space, typename Scalar>
inline constexpr bool kOfPath<PathReferences<Space, Scalar>> = true;

}  // namespace fpbm
