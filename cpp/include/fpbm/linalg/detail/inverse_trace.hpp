#pragma once

#include "fpbm/core/detail/unrolled.hpp"

namespace fpbm {

/// Trace of (L D Lᵀ)⁻¹ = Σ_i (1 + Σ_{j<i} (L⁻¹)²_ij) / D_i over m rows. The diagonal of L is 1 and is not read.
/// reciprocal is 1/D.
template <int kMost, typename Value, typename Size>
[[nodiscard, gnu::always_inline]] inline Value inverse_trace(const Value (&L)[kMost][kMost],
                                                             const Value (&reciprocal)[kMost], Size m) noexcept {
  constexpr Constant<0> kFirst{};
  Value inverse[kMost][kMost];  // −L⁻¹ below the diagonal.
  Value trace = reciprocal[0];
  each(next(kFirst), m, [&](auto i) {
    Value row = reciprocal[i];
    each(kFirst, i, [&](auto j) {
      Value entry = L[i][j];
      each(next(j), i, [&](Eigen::Index k) { entry -= L[i][k] * inverse[k][j]; });
      inverse[i][j] = entry;
      row += entry * entry * reciprocal[i];
    });
    trace += row;
  });
  return trace;
}

}  // namespace fpbm
