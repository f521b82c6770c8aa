#pragma once

#include <array>

#include "fpbm/core/mask.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// The references of a tick that a step of RK4 asks for: at its start, middle and end.
template <typename Space, typename Scalar = double>
struct TickReferences {
  std::array<Reference<Space, Scalar>, 3> stages;
  Number<Scalar> dt;  ///< Length of the tick [s].

  /// ahead(seconds): the reference some seconds into the tick; noexcept.
  template <typename Ahead>
  [[nodiscard]] static TickReferences of(Ahead&& ahead, Number<Scalar> dt) noexcept {
    return {{ahead(Number<Scalar>(0)), ahead(dt / Number<Scalar>(2)), ahead(dt)}, dt};
  }

  [[nodiscard]] const Reference<Space, Scalar>& operator()(Number<Scalar> seconds) const noexcept {
    return stages[seconds < dt ? (seconds > Number<Scalar>(0) ? 1 : 0) : 2];
  }

  /// The reference of a tick with one acceleration: that of its middle, with the acceleration
  /// xdd − h²x⁗/24 = xdd − (xdd₀ − 2xdd + xdd₁)/6, by which positions follow x at the ends of ticks
  /// (docs/equations.md).
  [[nodiscard]] Reference<Space, Scalar> middle() const noexcept {
    Reference<Space, Scalar> reference = stages[1];
    for (Eigen::Index i = 0; i < reference.xdd.size(); ++i) {
      const Scalar xdd = stages[1].xdd.coeff(i);
      const Scalar second_difference = stages[0].xdd.coeff(i) - xdd - xdd + stages[2].xdd.coeff(i);
      reference.xdd.coeffRef(i) -= second_difference / Scalar(6);
    }
    return reference;
  }

  /// The same seen from a point, in place of displacements from it. Other: lanes, say, where Scalar is not.
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

}  // namespace fpbm
