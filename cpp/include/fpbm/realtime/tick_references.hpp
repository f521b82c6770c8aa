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

  [[nodiscard]] const Reference<Space, Scalar>& operator()(Number<Scalar> seconds) const noexcept {
    return stages[seconds < dt ? (seconds > Number<Scalar>(0) ? 1 : 0) : 2];
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
