#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// What the tip is to do at one instant.
template <typename Space, typename Scalar = double>
struct Reference {
  typename Space::template Point<Scalar> x;  ///< Where the tip is to be, in the base frame [m, rad].
  Vector<Space::kRows, Scalar> xd;           ///< Its velocity, linear rows first, then angular [m/s, rad/s].
  Vector<Space::kRows, Scalar> xdd;          ///< Its acceleration [m/s², rad/s²].

  /// At rest on x.
  [[nodiscard]] static Reference hold(const typename Space::template Point<Scalar>& x) noexcept {
    return {x, Vector<Space::kRows, Scalar>::Zero(), Vector<Space::kRows, Scalar>::Zero()};
  }

  template <typename Other>
  [[nodiscard]] Reference<Space, Other> cast() const noexcept {
    return {x.template cast<Other>(), xd.template cast<Other>(), xdd.template cast<Other>()};
  }
};

}  // namespace fpbm
